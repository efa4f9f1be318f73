/* Wires: clouds' boxes and primitives' circles, projected as the picture is. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "panel.h"

enum { MOST_PRIMITIVES = 3000, CORNERS = 20 };

typedef struct projection {
    shape_camera camera;
    double right2, up2;
    float width, height;
} projection;

static projection project_from(const view_state *state, float width, float height)
{
    shape_view view = view_state_view(state, (int)width, (int)height);
    projection p = {.camera = shape_view_camera(&view), .width = width, .height = height};
    p.right2 = shape_dvec3_dot(p.camera.right, p.camera.right);
    p.up2 = shape_dvec3_dot(p.camera.up, p.camera.up);
    return p;
}

static bool project(const projection *p, shape_dvec3 point, float at[2])
{
    shape_dvec3 d = shape_dvec3_sub(point, p->camera.origin);
    double depth = shape_dvec3_dot(d, p->camera.forward);
    if (!(depth > 1e-3 * shape_dvec3_length(d)))
        return false;
    at[0] = (float)(shape_dvec3_dot(d, p->camera.right) / p->right2 / depth + 1) / 2 * p->width;
    at[1] = (float)(1 - shape_dvec3_dot(d, p->camera.up) / p->up2 / depth) / 2 * p->height;
    return true;
}

static void add(view_wires *wires, const projection *p, shape_dvec3 a, shape_dvec3 b)
{
    float from[2], to[2];
    if (!project(p, a, from) || !project(p, b, to))
        return;
    if (wires->count == wires->capacity) {
        size_t capacity = wires->capacity ? 2 * wires->capacity : 1024;
        float(*grown)[4] = realloc(wires->lines, capacity * sizeof *grown);
        if (!grown)
            return;
        wires->lines = grown;
        wires->capacity = capacity;
    }
    float *line = wires->lines[wires->count++];
    line[0] = from[0], line[1] = from[1], line[2] = to[0], line[3] = to[1];
}

void view_wires_boxes(view_wires *wires, const view_state *state, const shape_set *set, float width,
                      float height)
{
    projection p = project_from(state, width, height);
    for (size_t i = 0; i < set->cloud_count; i++) {
        shape_box box = shape_cloud_box(&set->clouds[i], shape_set_list_const(set, i));
        if (shape_box_is_empty(box))
            continue;
        shape_dvec3 corner[8];
        for (int c = 0; c < 8; c++)
            corner[c] = shape_frame_point(&set->clouds[i].frame,
                                          shape_dvec3_make((double)(c & 1 ? box.max.x : box.min.x),
                                                           (double)(c & 2 ? box.max.y : box.min.y),
                                                           (double)(c & 4 ? box.max.z : box.min.z)));
        for (int c = 0; c < 8; c++)
            for (int axis = 1; axis < 8; axis *= 2)
                if (!(c & axis))
                    add(wires, &p, corner[c], corner[c | axis]);
    }
}

/* The circle of an ellipsoid in the plane of two of its axes. */
static void add_circle(view_wires *wires, const projection *p, const shape_frame *frame, shape_dvec3 centre,
                       shape_dvec3 a, shape_dvec3 b)
{
    shape_dvec3 last = {0, 0, 0};
    for (int i = 0; i <= CORNERS; i++) {
        double angle = 2 * 3.14159265358979323846 * i / CORNERS;
        shape_dvec3 at = shape_dvec3_add(
            centre, shape_dvec3_add(shape_dvec3_scale(a, cos(angle)), shape_dvec3_scale(b, sin(angle))));
        at = shape_frame_point(frame, at);
        if (i)
            add(wires, p, last, at);
        last = at;
    }
}

static void add_ellipsoid(view_wires *wires, const projection *p, const shape_frame *frame,
                          const shape_ellipsoid *e)
{
    double m[3][3];
    shape_dvec3 axis[3], centre = {(double)e->x, (double)e->y, (double)e->z};
    shape_quat_matrix(e->q, m);
    for (int i = 0; i < 3; i++)
        axis[i] = shape_dvec3_scale(shape_dvec3_make(m[0][i], m[1][i], m[2][i]), (double)(&e->a)[i]);
    for (int i = 0; i < 3; i++)
        add_circle(wires, p, frame, centre, axis[i], axis[(i + 1) % 3]);
}

void view_wires_primitives(view_wires *wires, const view_state *state, const shape_set *set, float width,
                           float height)
{
    projection p = project_from(state, width, height);
    size_t shown = 0;
    for (size_t i = 0; i < set->cloud_count; i++) {
        const shape_primitives *list = shape_set_list_const(set, i);
        const shape_frame *frame = &set->clouds[i].frame;
        for (size_t k = 0; k < list->sphere_count && shown < MOST_PRIMITIVES; k++, shown++) {
            const shape_sphere *s = &list->spheres[k];
            shape_ellipsoid e = {s->x, s->y, s->z, 0, s->radius, s->radius, s->radius, 0, {0, 0, 0, 1}};
            add_ellipsoid(wires, &p, frame, &e);
        }
        for (size_t k = 0; k < list->ellipsoid_count && shown < MOST_PRIMITIVES; k++, shown++)
            add_ellipsoid(wires, &p, frame, &list->ellipsoids[k]);
    }
}

void view_wires_free(view_wires *wires)
{
    free(wires->lines);
    memset(wires, 0, sizeof *wires);
}
