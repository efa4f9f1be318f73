/* The joined intervals of all clouds on a ray (no duplicate tracing, on the union), and what they hold. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "light/march.h"

void march_path_free(shape_march_path *path)
{
    for (size_t i = 0; i < path->view_count; i++)
        shape_candidates_free(&path->views[i]);
    free(path->views);
    free(path->rays);
    free(path->edges);
    memset(path, 0, sizeof *path);
}

static shape_status prepare(shape_march_path *path, size_t clouds, shape_error *error)
{
    if (path->view_count == clouds)
        return SHAPE_OK;
    march_path_free(path);
    path->views = calloc(clouds + 1, sizeof *path->views);
    path->rays = calloc(clouds + 1, sizeof *path->rays);
    if (!path->views || !path->rays) {
        march_path_free(path);
        return shape_error_memory(error);
    }
    path->view_count = clouds;
    return SHAPE_OK;
}

static int compare_edges(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Pairs that meet become one. */
static size_t join(float *edges, size_t count)
{
    size_t kept = 0;
    for (size_t i = 0; i < count; i += 2) {
        if (kept && edges[i] <= edges[kept - 1]) {
            edges[kept - 1] = fmaxf(edges[kept - 1], edges[i + 1]);
            continue;
        }
        edges[kept++] = edges[i];
        edges[kept++] = edges[i + 1];
    }
    return kept;
}

shape_status march_path_find(const shape_marcher *marcher, shape_march_path *path, shape_dvec3 origin,
                             shape_dvec3 direction, bool all, size_t *count, shape_error *error)
{
    const shape_volume *volume = marcher->volume;
    shape_status status = prepare(path, volume->cloud_count, error);
    *count = 0;
    for (size_t i = 0; i < path->view_count && !status; i++) {
        const shape_volume_cloud *cloud = &volume->clouds[i];
        shape_ray local = shape_volume_ray(cloud, origin, direction);
        shape_candidates *found = &path->views[i];
        path->rays[i] = local;
        float t0 = 0, t1 = INFINITY, a, b;
        found->count = 0;
        if (marcher->clouds[i].hidden && !all)
            continue;
        if (!shape_box_intersect(cloud->box, local, &t0, &t1))
            continue;
        status = shape_cloud_candidates(cloud, local, t0, t1, found, error);
        size_t first, next = 0;
        while (!status && shape_candidates_join(found, t0, t1, &first, &next, &a, &b)) {
            status = shape_array_reserve((void **)&path->edges, &path->edge_capacity, *count + 2,
                                         sizeof(float), error);
            if (status)
                break;
            path->edges[(*count)++] = a;
            path->edges[(*count)++] = b;
        }
    }
    if (path->view_count > 1 && *count > 2) {
        qsort(path->edges, *count / 2, 2 * sizeof(float), compare_edges);
        *count = join(path->edges, *count);
    }
    return status;
}

double march_path_extinction(const shape_marcher *marcher, const shape_march_path *path, float t)
{
    double sum = 0;
    for (size_t i = 0; i < path->view_count; i++) {
        const shape_volume_cloud *cloud = &marcher->volume->clouds[i];
        const shape_candidates *found = &path->views[i];
        if (!found->count)
            continue;
        float u2 = shape_candidates_u2(found, 0, found->count, cloud->support * cloud->support, t);
        if (!(u2 <= cloud->support * cloud->support))
            continue;
        shape_ray local = path->rays[i];
        shape_vec3 p = shape_vec3_add(local.origin, shape_vec3_scale(local.direction, t));
        sum += (double)(cloud->medium.extinction * shape_cloud_density_at(cloud, p, u2));
    }
    return sum;
}
