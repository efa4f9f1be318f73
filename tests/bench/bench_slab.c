/* The whole table of plane-parallel slabs (normal incidence, Henyey-Greenstein, albedo 1) by walks through a `uniform`
 * ellipsoid flattened 2000 to 1, as CSV: the reflectance, its three standard errors and the table's value
 * (adding-doubling, 32 quadrature points). Takes a few minutes. Exit 1 where one is off by more than allowed. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "../scene_sample.h"
#include "shape/pathtrace.h"

static const double depths[5] = {0.5, 1, 2, 4, 8}, gs[4] = {0, 0.5, 0.75, 0.85};
static const double table[5][4] = {{0.20251, 0.08980, 0.03734, 0.01993},
                                   {0.34133, 0.17611, 0.07874, 0.04232},
                                   {0.51751, 0.32030, 0.16318, 0.09102},
                                   {0.69093, 0.50897, 0.31164, 0.19092},
                                   {0.82180, 0.68897, 0.50642, 0.35843}};
enum { WALKS = 2400000, BATCHES = 240 };

static double reflectance(double depth, double g)
{
    sample_scene scene = sample_begin(SHAPE_MODEL_UNIFORM, (float)depth);
    shape_tracer *tracer;
    scene.set->clouds[0].medium.g = (float)g;
    sample_add(&scene, 0, 0, 0, 1000, 0.5f, 1000);
    sample_finish(&scene);
    if (shape_tracer_create(scene.volume, &tracer, NULL))
        abort();
    long up = 0;
#pragma omp parallel for schedule(dynamic, 1) reduction(+ : up)
    for (int batch = 0; batch < BATCHES; batch++) {
        shape_random random = shape_random_seed(1, (uint64_t)batch);
        for (int i = 0; i < WALKS / BATCHES; i++)
            up += shape_tracer_walk(tracer, shape_dvec3_make(0, 2, 0), shape_dvec3_make(0, -1, 0), 1 << 20,
                                    &random)
                      .direction.y > 0;
    }
    shape_tracer_destroy(tracer);
    sample_end(&scene);
    return (double)up / WALKS;
}

int main(void)
{
    int bad = 0;
    printf("tau,g,reflectance,three_errors,table,good\n");
    for (int t = 0; t < 5; t++)
        for (int k = 0; k < 4; k++) {
            double r = reflectance(depths[t], gs[k]), three = 3 * sqrt(r * (1 - r) / WALKS);
            int good = fabs(r - table[t][k]) <= three + 2e-4;
            printf("%g,%g,%.5f,%.5f,%.5f,%d\n", depths[t], gs[k], r, three, table[t][k], good);
            fflush(stdout);
            bad += !good;
        }
    return bad > 0;
}
