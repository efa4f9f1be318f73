/* Thinning out and growing. */
#include "shape/refine.h"

#include <stdlib.h>

#include "primitive/axes.h"
#include "primitive/reach.h"
#include "shape/random.h"

enum { STREAM_THIN = 16, STREAM_GROW = 17 };

size_t shape_primitives_thin(shape_primitives *list, size_t keep, uint64_t seed)
{
    size_t count = shape_primitives_count(list), spheres = 0, ellipsoids = 0;
    if (count <= keep)
        return 0;
    shape_random random = shape_random_seed(seed, STREAM_THIN);
    for (size_t i = 0; i < count; i++) {
        size_t taken = spheres + ellipsoids;
        if (!(shape_random_unit(&random) * (double)(count - i) < (double)(keep - taken)))
            continue;
        if (i < list->sphere_count)
            list->spheres[spheres++] = list->spheres[i];
        else
            list->ellipsoids[ellipsoids++] = list->ellipsoids[i - list->sphere_count];
    }
    list->sphere_count = spheres;
    list->ellipsoid_count = ellipsoids;
    return count - keep;
}

shape_grow shape_grow_defaults(void)
{
    shape_grow options = {.levels = 2, .count = 10, .ratio = {0.35, 0.6}, .max_primitives = 1000000};
    return options;
}

static shape_status out_of_range(const char *what, double value, const char *range, shape_error *error)
{
    return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "%s is %g (it must be %s)", what, value, range);
}

shape_status shape_grow_check(const shape_grow *options, shape_error *error)
{
    if (options->levels < 1 || options->levels > 8)
        return out_of_range("grow-levels", options->levels, "1 to 8", error);
    if (options->count < 1 || options->count > 1000)
        return out_of_range("grow-count", options->count, "1 to 1000", error);
    if (!(options->ratio[0] >= 0.01 && options->ratio[0] <= 1))
        return out_of_range("the lower grow-ratio", options->ratio[0], "0.01 to 1", error);
    if (!(options->ratio[1] >= options->ratio[0] && options->ratio[1] <= 1))
        return out_of_range("the upper grow-ratio", options->ratio[1], "not below the lower, at most 1",
                            error);
    return SHAPE_OK;
}

/* A uniform direction (Marsaglia 1972), by square roots alone. */
static shape_dvec3 direction(shape_random *random)
{
    for (;;) {
        double u = shape_random_range(random, -1, 1), v = shape_random_range(random, -1, 1),
               s = u * u + v * v;
        if (s < 1) {
            double root = 2 * sqrt(1 - s);
            return shape_dvec3_make(u * root, v * root, 1 - 2 * s);
        }
    }
}

static shape_ellipsoid primitive(const shape_primitives *list, size_t i)
{
    return i < list->sphere_count ? shape_axes_sphere(&list->spheres[i])
                                  : list->ellipsoids[i - list->sphere_count];
}

static bool holds(const shape_ellipsoid *e, const double p[3])
{
    shape_dvec3 axes[3], offset = {p[0] - e->x, p[1] - e->y, p[2] - e->z};
    shape_axes_of(e, axes);
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double along = shape_dvec3_dot(axes[k], offset) / shape_dvec3_dot(axes[k], axes[k]);
        square += along * along;
    }
    return square < 1;
}

typedef struct cover {
    const shape_primitives *list;
    const double *point;
    size_t parent;
} cover;

static bool visit(const shape_reach_block *block, int k, void *context)
{
    const cover *c = context;
    size_t number = (size_t)block->number[k];
    if (number == c->parent)
        return false;
    shape_ellipsoid e = primitive(c->list, number);
    return holds(&e, c->point);
}

/* A sphere on the surface of primitive `parent`, at the same odds for each direction of the ball it is an image of. */
static shape_sphere child_of(const shape_ellipsoid *parent, const shape_grow *options, shape_random *random)
{
    shape_dvec3 axes[3], d = direction(random);
    double ratio = shape_random_range(random, options->ratio[0], options->ratio[1]);
    float smallest = parent->a < parent->b ? parent->a : parent->b;
    smallest = smallest < parent->c ? smallest : parent->c;
    shape_axes_of(parent, axes);
    shape_dvec3 at = shape_dvec3_add(
        shape_dvec3_make(parent->x, parent->y, parent->z),
        shape_dvec3_add(shape_dvec3_scale(axes[0], d.x),
                        shape_dvec3_add(shape_dvec3_scale(axes[1], d.y), shape_dvec3_scale(axes[2], d.z))));
    shape_sphere sphere = {(float)at.x, (float)at.y, (float)at.z, (float)(ratio * smallest)};
    return sphere;
}

/* Grows on the parents first..last, which are numbered as in the list at the level's start (spheres first). */
static shape_status grow_level(shape_primitives *list, const shape_grow *options, size_t first, size_t last,
                               shape_random *random, shape_error *error)
{
    shape_reach tree;
    shape_status status = shape_reach_build(&tree, list, error);
    shape_primitives before = *list; /* new spheres are appended behind; the tree knows these alone */
    shape_sphere *children = NULL;
    size_t tried = (last - first) * (size_t)options->count, kept = 0;
    if (!status) {
        children = malloc((tried ? tried : 1) * sizeof *children);
        if (!children)
            status = shape_error_memory(error);
    }
    for (size_t parent = first; parent < last && !status; parent++) {
        shape_ellipsoid from = primitive(&before, parent);
        for (int k = 0; k < options->count; k++) {
            shape_sphere child = child_of(&from, options, random);
            double p[3] = {child.x, child.y, child.z};
            cover c = {&before, p, parent};
            shape_reach_query query = {
                .min = {child.x, child.y, child.z}, .max = {child.x, child.y, child.z}, .before = INT32_MAX};
            if (!shape_reach_find(&tree, &query, visit, &c))
                children[kept++] = child;
        }
    }
    for (size_t i = 0; i < kept && !status; i++)
        status = shape_primitives_add_sphere(list, children[i], error);
    free(children);
    shape_reach_free(&tree);
    return status;
}

shape_status shape_primitives_grow(shape_primitives *list, const shape_grow *options, uint64_t seed,
                                   size_t *added, shape_error *error)
{
    shape_status status = shape_grow_check(options, error);
    size_t start = shape_primitives_count(list), first = 0, last = start;
    shape_random random = shape_random_seed(seed, STREAM_GROW);
    for (int level = 0; level < options->levels && !status && first < last; level++) {
        size_t count = shape_primitives_count(list), spheres = list->sphere_count;
        if ((last - first) >
            (options->max_primitives - (count < options->max_primitives ? count : options->max_primitives)) /
                (size_t)options->count) {
            status = shape_error_set(
                error, SHAPE_ERROR_LIMIT,
                "growing level %d could pass %zu primitives (fewer levels or a smaller count)", level + 1,
                options->max_primitives);
            break;
        }
        status = grow_level(list, options, first, last, &random, error);
        first = spheres;
        last = list->sphere_count;
    }
    if (added)
        *added = shape_primitives_count(list) - start;
    return status;
}
