/* Private: densities of a row of points that lie evenly along an axis of the cloud's frame. What a row shares is done once,
 * the rest in loops that compilers vectorise. */
#ifndef SHAPE_FIELD_ROW_H
#define SHAPE_FIELD_ROW_H

#include "base/stop.h"
#include "shape/volume.h"

enum { ROW_MOST = 320 }; /* points of a row at most */

/* Point i of `count` is low, moved by (i + 0.5) step along the axis (0 x, 1 y, 2 z). */
typedef struct field_row {
    int axis, count;
    float low[3], step;
} field_row;

/* The quadratic form of a primitive: u^2 = |m (p - c)|^2. A sphere has the identity over its radius. */
typedef struct row_form {
    float c[3], m[3][3];
} row_form;

/* A growing list, one a thread; zero it before first use (but for watch.stop), free items. All below tell the watch what they
 * do: where it says stop, row_collect fails, and what the others give is of no use (see row_stopped). */
typedef struct row_forms {
    row_form *items;
    size_t count, capacity;
    stop_watch watch;
} row_forms;

/* The primitives whose supports' boxes touch a box. The list is emptied first. */
shape_status row_collect(const shape_volume_cloud *cloud, shape_vec3 low, shape_vec3 high, row_forms *list,
                         shape_error *error);
/* min u^2 of a row's points over the supports, grown by `support`, that hold them; INFINITY outside all. */
void row_u2(row_forms *list, float support, const field_row *row, float *u2);
/* shape_cloud_density_at of each point, to a few roundings. */
void row_density(const shape_volume_cloud *cloud, row_forms *list, const field_row *row, const float *u2,
                 float *density);
/* The error where the watch has said stop. */
shape_status row_stopped(const row_forms *list, shape_error *error);

#endif
