/* Processor time to the same variance, the path tracer against its naive twin, on a 35-sphere `spheroid` cumulus of optical depth
 * about 30, as CSV. Both use the same rows of threads, sun (a direction) and sky. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "../scene_sample.h"
#include "../twin_delta.h"
#include "shape/pathtrace.h"

enum { WIDTH = 96, HEIGHT = 54, SAMPLES = 256, DEPTHS = 200 };

static double seconds(void) /* of the processor, all threads */
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Mean over pixels and channels of the variance of one sample; *mean gets the mean radiance. */
static double render_twin(const shape_volume *volume, const shape_view *view, const shape_light *light,
                          double *mean)
{
    shape_camera camera = shape_view_camera(view);
    double variance = 0, sum = 0;
#pragma omp parallel for schedule(dynamic, 1) reduction(+ : variance, sum)
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            shape_random random = shape_random_seed(1, (uint64_t)(y * WIDTH + x));
            double first[3] = {0, 0, 0}, second[3] = {0, 0, 0}, rgb[3];
            for (int i = 0; i < SAMPLES; i++) {
                shape_dvec3 d = shape_camera_direction(&camera, view, x + shape_random_unit(&random),
                                                       y + shape_random_unit(&random));
                twin_radiance(volume, light, view->eye, d, &random, rgb);
                for (int c = 0; c < 3; c++) {
                    first[c] += rgb[c];
                    second[c] += rgb[c] * rgb[c];
                }
            }
            for (int c = 0; c < 3; c++) {
                sum += first[c];
                variance += (second[c] - first[c] * first[c] / SAMPLES) / (SAMPLES - 1);
            }
        }
    *mean = sum / (3.0 * WIDTH * HEIGHT * SAMPLES);
    return variance / (3.0 * WIDTH * HEIGHT);
}

/* The mean optical depth of rays through the picture's middle. */
static double middle_depth(const shape_volume *volume, const shape_view *view)
{
    shape_camera camera = shape_view_camera(view);
    shape_candidates scratch = {0};
    double sum = 0;
    int hits = 0;
    for (int i = 0; i < DEPTHS; i++) {
        double depth, x = WIDTH * (0.35 + 0.3 * i / DEPTHS), y = HEIGHT * (0.45 + 0.001 * (i % 100));
        if (shape_volume_optical_depth(volume, view->eye, shape_camera_direction(&camera, view, x, y), 0,
                                       1e4f, 0.02f, &scratch, &depth, NULL))
            abort();
        sum += depth;
        hits++;
    }
    shape_candidates_free(&scratch);
    return sum / hits;
}

int main(void)
{
    static float radiance[3 * WIDTH * HEIGHT], variance[3 * WIDTH * HEIGHT];
    sample_scene scene = sample_cumulus(35, 15);
    shape_light light = shape_light_defaults();
    shape_view view = shape_view_defaults();
    shape_pathtrace_options options = shape_pathtrace_defaults();
    shape_pathtrace_result result;
    shape_dvec3 min, max;
    shape_tracer *tracer;
    light.sky = SHAPE_SKY_CONSTANT; /* cheap for both */
    light.sky_radiance[0] = 0.2f, light.sky_radiance[1] = 0.3f, light.sky_radiance[2] = 0.5f;
    view.width = WIDTH, view.height = HEIGHT;
    options.samples = SAMPLES;
    options.sun_angle = 0;
    shape_set_bounds(scene.set, &min, &max);
    shape_view_frame(&view, &light, min, max);
    printf("who,seconds,variance,mean,seconds_times_variance\n");
    double start = seconds(), mean, ours = 0;
    if (shape_tracer_create(scene.volume, &tracer, NULL) ||
        shape_pathtrace_render(tracer, &view, &light, &options, radiance, variance, &result, NULL))
        return 1;
    double time = seconds() - start;
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++)
        ours += (double)variance[i] * SAMPLES / (3.0 * WIDTH * HEIGHT);
    double ours_cost = time * ours;
    printf("grid,%.3f,%.5f,%.5f,%.5f\n", time, ours, (result.mean[0] + result.mean[1] + result.mean[2]) / 3,
           ours_cost);
    start = seconds();
    double twins = render_twin(scene.volume, &view, &light, &mean);
    time = seconds() - start;
    printf("twin,%.3f,%.5f,%.5f,%.5f\n", time, twins, mean, time * twins);
    printf("# optical depth %.1f; the grid needs %.1f times less time to the same variance\n",
           middle_depth(scene.volume, &view), time * twins / ours_cost);
    shape_tracer_destroy(tracer);
    sample_end(&scene);
    return 0;
}
