/* How the error of each rule falls with its step, as CSV: the mean over rays of the difference from the same ray summed
 * by very many steps. On a smooth density (a ray through a uniform ball, whose way to the sun is smooth too) each falls
 * at its own order; on `spheroid`, whose density jumps at its threshold, all fall at order 1. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../scene_sample.h"
#include "shape/march.h"

static const char *const rules[] = {"riemann-left", "riemann-right", "trapezoid",
                                    "simpson",      "simpson38",     "exponential"};
enum { RULES = 6, RAYS = 48, FINEST = 1024 };

static void see(const sample_scene *scene, const shape_march_options *options, bool smooth, double seen[RAYS])
{
    shape_light light = shape_light_defaults();
    shape_marcher *marcher;
    light.sky = SHAPE_SKY_NONE;
    if (smooth)
        light.sun = shape_dvec3_make(1, 0, 0);
    if (shape_marcher_create(scene->volume, &light, light.sun, options, &marcher, NULL))
        abort();
#pragma omp parallel for schedule(dynamic, 1)
    for (int i = 0; i < RAYS; i++) {
        shape_march_scratch scratch;
        double rgb[3], x = smooth ? 0.4 + 0.8 * i / RAYS : 2.4 * i / RAYS - 1.2;
        shape_dvec3 eye = {x, smooth ? 0.3 : 1 + 0.01 * i, 12}, direction = {0, 0, -1};
        memset(&scratch, 0, sizeof scratch);
        if (shape_march_radiance(marcher, eye, direction, 0, &scratch, rgb, NULL))
            abort();
        seen[i] = rgb[0];
        shape_march_scratch_free(&scratch);
    }
    shape_marcher_destroy(marcher);
}

static void measure(const char *name, const sample_scene *scene, bool smooth)
{
    shape_march_options options = shape_march_defaults();
    double truth[RAYS], seen[RAYS];
    const double side = 6;
    options.light = SHAPE_MARCH_SINGLE;
    options.light_step = 0.1;
    options.rule = SHAPE_RULE_SIMPSON;
    options.step = side / (smooth ? 4 * FINEST : 16 * FINEST);
    see(scene, &options, smooth, truth);
    for (int rule = 0; rule < RULES; rule++)
        for (int steps = 16; steps <= FINEST; steps *= 2) {
            double error = 0;
            options.rule = (shape_rule)rule;
            options.step = side / steps;
            see(scene, &options, smooth, seen);
            for (int i = 0; i < RAYS; i++)
                error += fabs(seen[i] - truth[i]) / RAYS;
            printf("%s,%s,%d,%.4g\n", name, rules[rule], steps, error);
            fflush(stdout);
        }
}

int main(void)
{
    sample_scene smooth = sample_begin(SHAPE_MODEL_UNIFORM, 1), cumulus = sample_cumulus(8, 3);
    smooth.set->clouds[0].medium.phase = SHAPE_PHASE_ISOTROPIC;
    sample_add(&smooth, 0, 0, 0, 3, 3, 3);
    sample_finish(&smooth);
    printf("scene,rule,steps,error\n");
    measure("smooth", &smooth, true);
    measure("spheroid", &cumulus, false);
    sample_end(&smooth);
    sample_end(&cumulus);
    return 0;
}
