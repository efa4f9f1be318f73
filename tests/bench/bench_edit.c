/* One primitive of many is moved: light and baked voxels made anew, against made again where the edit changed them. Clouds of
 * 35, 350 and 3,500 spheres; medians of several runs, the two ways in turn, on one thread and on that thread's own time; the
 * share of the work (rows of the sweep evaluated) does not depend on the machine. Also the scattered light, which is solved
 * for the whole cloud either way. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "shape/bake.h"
#include "shape/change.h"
#include "shape/lightgrid.h"
#include "shape/random.h"
#include "shape/sunsweep.h"

enum { RUNS = 7, CELLS = 48, VOXELS = 4000000 };

static void must(shape_status status, const shape_error *error)
{
    if (status) {
        fprintf(stderr, "bench_edit: %s\n", error->text);
        exit(1);
    }
}

static double work_ms(void)
{
    struct timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values)
{
    qsort(values, RUNS, sizeof *values, compare);
    return values[RUNS / 2];
}

/* Spheres that fill a ball 8 m wide, the smaller the more, so that they overlap alike; moved: number 0 by half its radius. */
static shape_volume *heap_of(size_t count, bool moved, shape_set **set)
{
    shape_error error;
    shape_random random = shape_random_seed(1, 0);
    float radius = 4 * (float)cbrt(1.2 / (double)count);
    size_t index;
    *set = shape_set_create(&error);
    must(*set ? SHAPE_OK : error.status, &error);
    must(shape_set_add_cloud(*set, "heap", &index, &error), &error);
    for (size_t i = 0; i < count;) {
        shape_sphere s = {(float)shape_random_range(&random, -4, 4),
                          (float)shape_random_range(&random, -4, 4),
                          (float)shape_random_range(&random, -4, 4), radius};
        if (s.x * s.x + s.y * s.y + s.z * s.z > (i ? 16.0f : 4.0f)) /* number 0 lies within */
            continue;
        if (!i && moved)
            s.x += 0.5f * radius;
        must(shape_primitives_add_sphere(shape_set_list(*set, 0), s, &error), &error);
        i++;
    }
    (*set)->clouds[0].field.noise_scale = 0.5f;
    shape_volume *volume;
    must(shape_volume_create(*set, &volume, &error), &error);
    return volume;
}

/* What was there before, and what is made of it. */
typedef struct bench {
    shape_volume *volumes[2];
    shape_light light;
    shape_change change;
    float voxel;
    shape_baked baked;
    shape_sunsweep *sweep;
    shape_lightgrid grid;
    uint64_t rows;
} bench;

enum { FIND, BAKE, SWEEP, GRID, SCATTER, PARTS };

static shape_lightgrid grid_of(const bench *b, int which, const shape_sunsweep *sweep, bool again,
                               bool scattering)
{
    shape_error error;
    shape_lightgrid grid;
    shape_lightgrid_options options = shape_lightgrid_defaults();
    options.resolution = CELLS;
    options.threads = 1;
    options.sweep = sweep;
    options.scattering = scattering;
    options.from = again ? &b->grid : NULL;
    options.change = again ? &b->change : NULL;
    must(shape_lightgrid_build(b->volumes[which], 0, &b->light, &options, &grid, &error), &error);
    return grid;
}

static shape_sunsweep *sweep_of(const bench *b, int which, bool again)
{
    shape_error error;
    const int cells = 2 * CELLS;
    shape_sunsweep *sweep;
    shape_sunsweep_options options = {.threads = 1, .keep = true};
    if (again)
        options.from = b->sweep, options.changes = &b->change;
    must(shape_sunsweep_create_with(b->volumes[which], &b->light, &cells, &options, &sweep, &error), &error);
    return sweep;
}

/* The edit by one of the ways; what was there before is made anew first, unmeasured. */
static void run(bench *b, bool again, double took[PARTS])
{
    shape_error error;
    must(shape_bake(&b->volumes[0]->clouds[0], b->voxel, 0, &b->baked, &error), &error);
    b->sweep = sweep_of(b, 0, false);
    b->grid = grid_of(b, 0, b->sweep, false, true);
    double start = work_ms();
    must(shape_change_find(&b->volumes[0]->clouds[0], &b->volumes[1]->clouds[0], &b->change, &error), &error);
    took[FIND] = work_ms() - start, start = work_ms();
    shape_baked baked = {0};
    if (again)
        must(shape_bake_again(&b->volumes[1]->clouds[0], &b->change, 1, (shape_stop){0}, &b->baked, NULL,
                              &error),
             &error);
    else
        must(shape_bake(&b->volumes[1]->clouds[0], b->voxel, 1, &baked, &error), &error);
    took[BAKE] = work_ms() - start, start = work_ms();
    shape_sunsweep *sweep = sweep_of(b, 1, again);
    took[SWEEP] = work_ms() - start, start = work_ms();
    shape_lightgrid grid = grid_of(b, 1, sweep, again, false);
    took[GRID] = work_ms() - start, start = work_ms();
    shape_lightgrid scattered = grid_of(b, 1, sweep, again, true);
    took[SCATTER] = work_ms() - start;
    b->rows = shape_sunsweep_rows(sweep);
    shape_sunsweep_destroy(sweep);
    shape_sunsweep_destroy(b->sweep);
    shape_lightgrid_free(&grid);
    shape_lightgrid_free(&scattered);
    shape_lightgrid_free(&b->grid);
    shape_baked_free(&baked);
    shape_baked_free(&b->baked);
    shape_change_free(&b->change);
}

int main(void)
{
    static const size_t counts[] = {35, 350, 3500};
    static const char *const names[PARTS] = {"finding the change", "baked voxels", "sweep along the sun",
                                             "the sun in the grid", "the grid with scattered light"};
    printf("spheres,part,anew [ms],again [ms],ratio\n");
    for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
        bench b = {.light = shape_light_defaults()};
        shape_set *sets[2];
        double took[2][RUNS][PARTS], rows[2], sum[2] = {0, 0};
        b.light.sun = shape_sun_direction(60, 40);
        for (int i = 0; i < 2; i++)
            b.volumes[i] = heap_of(counts[c], i, &sets[i]);
        shape_volume_keep_boxes(b.volumes[1], b.volumes[0]);
        b.voxel = shape_bake_voxel(&b.volumes[0]->clouds[0], 0.001f, VOXELS);
        for (int r = 0; r < RUNS; r++)
            for (int again = 0; again < 2; again++) {
                run(&b, again, took[again][r]);
                rows[again] = (double)b.rows;
            }
        for (int part = 0; part < PARTS; part++) {
            double mid[2], values[RUNS];
            for (int again = 0; again < 2; again++) {
                for (int r = 0; r < RUNS; r++)
                    values[r] = took[again][r][part];
                mid[again] = median(values);
                /* Without comparing there is no change to find. */
                sum[again] += part == SCATTER || (part == FIND && !again) ? 0 : mid[again];
            }
            printf("%zu,\"%s\",%.2f,%.2f,%.1f\n", counts[c], names[part], mid[0], mid[1], mid[0] / mid[1]);
        }
        printf("%zu,\"all but scattered light\",%.2f,%.2f,%.1f\n", counts[c], sum[0], sum[1],
               sum[0] / sum[1]);
        printf("%zu,\"rows of the sweep evaluated\",%.0f,%.0f,%.1f\n", counts[c], rows[0], rows[1],
               rows[0] / rows[1]);
        for (int i = 0; i < 2; i++) {
            shape_volume_destroy(b.volumes[i]);
            shape_set_destroy(sets[i]);
        }
    }
    return 0;
}
