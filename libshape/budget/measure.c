/* The measure of simplification: density at one point in each cell of a grid, light by sweeps through it from three
 * sides, pictures by sweeps from six. Light that is scattered often is stood in for by three octaves (Wrenninge, Kulla and
 * Lundqvist 2013: depth and weight halved each time). Only shape_exp, + - * / and sqrt, and every sum in a fixed order. */
#include "budget/measure.h"

#include <stdlib.h>
#include <string.h>

#include "shape/random.h"
#include "shape/volume.h"

/* What reaches every cell, where each of the octaves' light is 1 outside. */
static const double sky = 0.5;

enum { SUNS = 3, OCTAVES = 3, PICTURES = 1 + SUNS };

/* A list as a volume of its own. The set does not own the list; end() lets go of it. */
typedef struct rig {
    shape_set *set;
    shape_volume *volume;
} rig;

static void rig_end(rig *r)
{
    shape_volume_destroy(r->volume);
    if (r->set && r->set->list_count)
        memset(&r->set->lists[0], 0, sizeof r->set->lists[0]);
    shape_set_destroy(r->set);
}

static shape_status rig_begin(rig *r, const shape_primitives *list, const shape_cloud *cloud,
                              shape_error *error)
{
    memset(r, 0, sizeof *r);
    r->set = shape_set_create(error);
    shape_status status = r->set ? shape_set_add_cloud(r->set, "measured", NULL, error) : SHAPE_ERROR_MEMORY;
    if (!status) {
        r->set->clouds[0].field = cloud->field;
        r->set->clouds[0].medium = cloud->medium;
        r->set->lists[0] = *list;
        status = shape_volume_create(r->set, &r->volume, error);
    }
    if (status)
        rig_end(r);
    else
        r->volume->clouds[0].portable = true;
    return status;
}

/* The supports of metaballs are far larger than what they show: the box round the cells of a coarse grid that hold
 * density, and one cell more. */
static shape_box shown_box(const shape_volume_cloud *cloud, shape_box box)
{
    enum { CELLS = 32 };
    shape_vec3 cell = shape_vec3_scale(shape_vec3_sub(box.max, box.min), 1.0f / CELLS);
    shape_box shown = shape_box_empty();
    for (int i = 0; i < CELLS * CELLS * CELLS; i++) {
        float x = (float)(i % CELLS), y = (float)(i / CELLS % CELLS), z = (float)(i / CELLS / CELLS);
        shape_vec3 p = {box.min.x + (x + 0.5f) * cell.x, box.min.y + (y + 0.5f) * cell.y,
                        box.min.z + (z + 0.5f) * cell.z};
        if (shape_cloud_density(cloud, p) > 0) {
            shown = shape_box_add_point(shown, shape_vec3_sub(p, shape_vec3_scale(cell, 1.5f)));
            shown = shape_box_add_point(shown, shape_vec3_add(p, shape_vec3_scale(cell, 1.5f)));
        }
    }
    return shape_box_is_empty(shown) ? box : shown;
}

shape_status budget_stage_set(budget_stage *stage, const shape_primitives *list, const shape_cloud *cloud,
                              int resolution, shape_error *error)
{
    memset(stage, 0, sizeof *stage);
    stage->cloud.field = cloud->field;
    stage->cloud.medium = cloud->medium;
    stage->cloud.frame = cloud->frame;
    rig r;
    shape_status status = rig_begin(&r, list, cloud, error);
    if (status)
        return status;
    shape_box box = r.volume->clouds[0].box;
    if (cloud->field.model == SHAPE_MODEL_METABALL && !shape_box_is_empty(box))
        box = shown_box(&r.volume->clouds[0], box);
    rig_end(&r);
    if (shape_box_is_empty(box))
        return SHAPE_OK;
    double side[3] = {(double)box.max.x - box.min.x, (double)box.max.y - box.min.y,
                      (double)box.max.z - box.min.z};
    double longest = side[0] > side[1] ? side[0] : side[1];
    longest = longest > side[2] ? longest : side[2];
    if (!(longest > 0))
        return SHAPE_OK; /* thinner than single precision tells: nothing to be seen */
    double cell = longest * 1.25 / resolution;
    for (int k = 0; k < 3; k++) {
        int cells = (int)(side[k] * 1.25 / cell + 0.999);
        stage->size[k] = cells < 4 ? 4 : cells > resolution ? resolution : cells;
        double middle = 0.5 * ((double)(&box.min.x)[k] + (&box.max.x)[k]);
        double wide = side[k] * 1.25, least = 1e-6 * longest;
        wide = wide > least ? wide : least;
        (&stage->box.min.x)[k] = (float)(middle - wide / 2);
        (&stage->box.max.x)[k] = (float)(middle + wide / 2);
        shape_dvec3 axis = {cloud->frame.m[0][k], cloud->frame.m[1][k], cloud->frame.m[2][k]};
        stage->length[k] = wide / stage->size[k] * shape_dvec3_length(axis);
    }
    size_t x = (size_t)stage->size[0], y = (size_t)stage->size[1], z = (size_t)stage->size[2];
    stage->values = 2 * PICTURES * (x * y + y * z + z * x);
    return SHAPE_OK;
}

/* Density at a point of each cell, somewhere in it, so that the points keep no step with the noise's lattice. */
static void sample(const budget_stage *stage, const shape_volume_cloud *cloud, float *density)
{
    const int *n = stage->size;
    const shape_box *box = &stage->box;
    float scale[3];
    for (int k = 0; k < 3; k++)
        scale[k] = ((&box->max.x)[k] - (&box->min.x)[k]) / (float)n[k];
#pragma omp parallel for schedule(dynamic)
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++)
            for (int x = 0; x < n[0]; x++) {
                size_t cell = ((size_t)z * (size_t)n[1] + (size_t)y) * (size_t)n[0] + (size_t)x;
                uint64_t hash = shape_hash(cell);
                float jitter[3];
                for (int k = 0; k < 3; k++)
                    jitter[k] = (float)(hash >> (20 * k) & 0xfffff) / 0x100000;
                shape_vec3 p = {box->min.x + ((float)x + jitter[0]) * scale[0],
                                box->min.y + ((float)y + jitter[1]) * scale[1],
                                box->min.z + ((float)z + jitter[2]) * scale[2]};
                density[cell] = shape_cloud_density(cloud, p);
            }
}

/* The columns of cells along an axis: where column c begins, and how far apart its cells are. */
typedef struct columns {
    size_t count, length, stride;
    size_t wide, step_wide, step_high;
} columns;

static columns columns_along(const int n[3], int axis)
{
    size_t x = (size_t)n[0], y = (size_t)n[1], z = (size_t)n[2];
    switch (axis) {
    case 0:
        return (columns){y * z, x, 1, y, x, x * y};
    case 1:
        return (columns){x * z, y, x, x, 1, x * y};
    default:
        return (columns){x * y, z, x * y, x, 1, x};
    }
}

static size_t column_begin(const columns *c, size_t number)
{
    return number % c->wide * c->step_wide + number / c->wide * c->step_high;
}

/* The light at the middle of each cell that holds density, for a sun at the axis' positive end. */
static void shine(const columns *c, double depth, const float *density, float *light)
{
#pragma omp parallel for
    for (size_t number = 0; number < c->count; number++) {
        size_t begin = column_begin(c, number);
        double passed = 0;
        for (size_t i = c->length; i-- > 0;) {
            size_t cell = begin + i * c->stride;
            double own = depth * (double)density[cell], share = 1, sum = sky;
            if (!(density[cell] > 0))
                continue;
            for (int octave = 0; octave < OCTAVES; octave++, share *= 0.25)
                sum += shape_exp(-share * (passed + own / 2));
            light[cell] = (float)sum;
            passed += own;
        }
    }
}

/* One column seen from both of its ends: cover and the radiance of each sun. */
static void look_along(const columns *c, size_t number, double depth, const float *density,
                       float *const light[SUNS], double *front, double *back)
{
    size_t begin = column_begin(c, number);
    double clear = 1;
    /* The front gathers what is still seen, the back lays each cell over those behind it: one exponential serves both. */
    for (size_t i = 0; i < c->length; i++) {
        size_t cell = begin + i * c->stride;
        if (!(density[cell] > 0))
            continue;
        double through = shape_exp(-depth * (double)density[cell]);
        for (int s = 0; s < SUNS; s++) {
            double shown = (1 - through) * (double)light[s][cell];
            front[(size_t)(1 + s) * c->count + number] += clear * shown;
            double *behind = &back[(size_t)(1 + s) * c->count + number];
            *behind = *behind * through + shown;
        }
        clear *= through;
    }
    front[number] = back[number] = 1 - clear;
}

static void draw(const budget_stage *stage, const float *density, float *const light[SUNS], double *pictures)
{
    size_t offset = 0;
    double extinction = (double)stage->cloud.medium.extinction;
    memset(pictures, 0, stage->values * sizeof *pictures);
    for (int axis = 0; axis < 3; axis++) {
        columns c = columns_along(stage->size, axis);
        shine(&c, extinction * stage->length[axis], density, light[axis]);
    }
    for (int axis = 0; axis < 3; axis++) {
        columns c = columns_along(stage->size, axis);
        double depth = extinction * stage->length[axis];
        double *front = pictures + offset, *back = front + PICTURES * c.count;
#pragma omp parallel for
        for (size_t number = 0; number < c.count; number++)
            look_along(&c, number, depth, density, light, front, back);
        offset += 2 * PICTURES * c.count;
    }
}

shape_status budget_pictures_draw(const budget_stage *stage, const shape_primitives *list, double *pictures,
                                  shape_error *error)
{
    size_t cells = (size_t)stage->size[0] * (size_t)stage->size[1] * (size_t)stage->size[2];
    if (!stage->values)
        return SHAPE_OK;
    rig r;
    shape_status status = rig_begin(&r, list, &stage->cloud, error);
    if (status)
        return status;
    float *density = malloc((1 + SUNS) * cells * sizeof *density);
    if (density) {
        float *light[SUNS];
        for (int s = 0; s < SUNS; s++)
            light[s] = density + (size_t)(1 + s) * cells;
        sample(stage, &r.volume->clouds[0], density);
        draw(stage, density, light, pictures);
    } else {
        status = shape_error_memory(error);
    }
    free(density);
    rig_end(&r);
    return status;
}

/* The RMS difference of so many values, relative to their RMS. */
static double relative_change(const double *from, const double *to, size_t count)
{
    double differences = 0, squares = 0;
    for (size_t i = 0; i < count; i++) {
        double difference = to[i] - from[i];
        differences += difference * difference;
        squares += from[i] * from[i];
    }
    return differences > 0 ? sqrt(differences / squares) : 0;
}

double budget_pictures_change(const budget_stage *stage, const double *from, const double *to)
{
    double largest = 0;
    for (int side = 0; side < 6 && stage->values; side++) {
        size_t count = columns_along(stage->size, side / 2).count;
        double cover = relative_change(from, to, count);
        double radiance = relative_change(from + count, to + count, SUNS * count);
        double change = cover > radiance ? cover : radiance;
        largest = change > largest ? change : largest;
        from += PICTURES * count;
        to += PICTURES * count;
    }
    return largest;
}
