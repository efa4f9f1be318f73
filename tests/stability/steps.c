/* Steps: rules of integration at any step's optical depth, the form 1 - x, whole steps, steps adapted to something opaque,
 * steps that grow with the distance, and accumulated places. */
#include "row.h"
#include "shape/opaque.h"
#include "shape/paper.h"

/* --- rules --- */

static const double step_depths[] = {0.01, 0.1, 0.3, 1, 3, 10, 30, 100};
enum { STEP_DEPTHS = sizeof step_depths / sizeof *step_depths };

/* A black ball that glows with a source of 1, of optical diameter 100: what leaves it is 1 - exp(-100). */
static double glow(shape_rule rule, double step_depth)
{
    const double diameter = 2, depth = 100;
    sample_scene scene = stability_ball(diameter / 2, depth / diameter, 0);
    shape_light light = shape_light_defaults();
    shape_march_options options = shape_march_defaults();
    light.sky = SHAPE_SKY_NONE;
    options.light = SHAPE_MARCH_SINGLE;
    options.rule = rule;
    options.emission[0] = (float)(depth / diameter);
    options.step = diameter / depth * step_depth * (1 + 1e-5);
    double seen =
        stability_look(&scene, &light, &options, shape_dvec3_make(0, 0, 5), shape_dvec3_make(0, 0, -1));
    sample_end(&scene);
    return seen;
}

/* Of all depths of a step, the result farthest from 1. */
static double worst_glow(shape_rule rule)
{
    double worst = 1;
    for (int i = 0; i < STEP_DEPTHS; i++) {
        double seen = glow(rule, step_depths[i]);
        if (!(fabs(seen - 1) <= fabs(worst - 1)))
            worst = seen;
    }
    return worst;
}

static void measure_rule(double rule, double *plain, double *ours)
{
    *plain = worst_glow((shape_rule)(int)rule);
    *ours = worst_glow(SHAPE_RULE_EXPONENTIAL);
}

/* --- 1 - x for exp(-x) --- */

static double transmittance_of_ball(double depth, double step)
{
    sample_scene scene = stability_ball(1, depth / 2, 0);
    shape_light light = stability_white_sky();
    shape_march_options options = shape_march_defaults();
    options.light = SHAPE_MARCH_SINGLE;
    options.step = step;
    double seen =
        stability_look(&scene, &light, &options, shape_dvec3_make(0, 0, 5), shape_dvec3_make(0, 0, -1));
    sample_end(&scene);
    return seen;
}

static void one_minus_x(double x, double *plain, double *ours)
{
    enum { STEPS = 5 };
    *plain = 1;
    for (int i = 0; i < STEPS; i++)
        *plain *= 1 - x;
    *ours = transmittance_of_ball(x * STEPS, 2.0 / STEPS);
}

/* --- whole steps: rings --- */

enum { ACROSS = 256 };
static const double ring_sigma = 5;

/* The largest change of transmittance from one ray to the next over that of the closed form exp(-sigma chord): rays side
 * by side through the middle half of a ball. */
static double largest_jump(const double seen[ACROSS])
{
    double most = 0;
    for (int i = 1; i < ACROSS; i++)
        most = fmax(most, fabs(log(seen[i]) - log(seen[i - 1])));
    return most;
}

static shape_view strip_view(void)
{
    shape_view view = shape_view_defaults();
    view.width = ACROSS, view.height = 1;
    view.eye = shape_dvec3_make(0, 0, 50);
    view.fov = 2 * atan(0.5 / 50 / ACROSS) * 180 / 3.14159265358979;
    return view;
}

static void whole_steps(double x, double *plain, double *ours)
{
    (void)x;
    sample_scene scene = stability_ball(1, ring_sigma, 0);
    shape_view view = strip_view();
    shape_light light = stability_white_sky();
    shape_paper_options paper = shape_paper_defaults();
    shape_march_options options = shape_march_defaults();
    shape_marcher *marcher;
    shape_error error;
    float radiance[3 * ACROSS];
    double seen[ACROSS];
    paper.resolution = 2;
    options.light = SHAPE_MARCH_SINGLE;
    options.step = 0.1;
    stability_must(shape_paper_render(scene.volume, &view, &light, &paper, radiance, NULL, NULL, &error),
                   &error);
    for (int i = 0; i < ACROSS; i++)
        seen[i] = (double)radiance[3 * i];
    *plain = largest_jump(seen);
    stability_must(shape_marcher_create(scene.volume, &light, view.eye, &options, &marcher, &error), &error);
    stability_must(shape_march_render(marcher, &view, radiance, NULL, &error), &error);
    shape_marcher_destroy(marcher);
    for (int i = 0; i < ACROSS; i++)
        seen[i] = (double)radiance[3 * i];
    *ours = largest_jump(seen);
    sample_end(&scene);
}

/* --- something opaque inside thick cloud --- */

static shape_opaque *square_at(double z)
{
    shape_error error;
    float white[3] = {1, 1, 1};
    shape_mesh *mesh = shape_mesh_create(3, 1, &error);
    shape_opaque *opaque = shape_opaque_create(&error);
    if (!mesh || !opaque)
        abort();
    mesh->point_count = 3, mesh->triangle_count = 1;
    mesh->points[0] = shape_dvec3_make(-50, -50, z);
    mesh->points[1] = shape_dvec3_make(50, -50, z);
    mesh->points[2] = shape_dvec3_make(0, 90, z);
    mesh->indices[0] = 0, mesh->indices[1] = 1, mesh->indices[2] = 2;
    stability_must(shape_opaque_add(opaque, mesh, NULL, white, &error), &error);
    stability_must(shape_opaque_finish(opaque, &error), &error);
    shape_mesh_destroy(mesh);
    return opaque;
}

/* Behind a depth of 25 nothing shows, so the picture is the same with and without it. */
static void occluder(double x, double *plain, double *ours)
{
    (void)x;
    sample_scene scene = stability_ball(2, 12, 1);
    shape_opaque *opaque = square_at(-0.1);
    shape_light light = shape_light_defaults();
    shape_march_options options = shape_march_defaults();
    shape_dvec3 eye = {0.1, 0.2, 9}, d = {0, 0, -1};
    light.sky = SHAPE_SKY_NONE;
    light.sun = shape_dvec3_make(0, 0.8, 0.6);
    options.light = SHAPE_MARCH_SINGLE;
    options.rule = SHAPE_RULE_RIEMANN_LEFT;
    options.step = 0.25;
    double without = stability_look(&scene, &light, &options, eye, d);
    options.opaque = opaque;
    *ours = stability_look(&scene, &light, &options, eye, d) / without;
    options.end = SHAPE_END_ADAPT;
    *plain = stability_look(&scene, &light, &options, eye, d) / without;
    shape_opaque_destroy(opaque);
    sample_end(&scene);
}

/* Light at a place in the shadow of a thing, with `--shade 0`: shade times the depth to the sun, which is infinite. */
static void shaded_shadow(double x, double *plain, double *ours)
{
    sample_scene scene = stability_ball(2, 0.5, 1);
    shape_opaque *opaque = square_at(4);
    shape_light light = shape_light_defaults();
    shape_march_options options = shape_march_defaults();
    volatile float depth = INFINITY;
    light.sky = SHAPE_SKY_NONE;
    light.sun = shape_dvec3_make(0, 0, 1);
    options.light = SHAPE_MARCH_SINGLE;
    options.opaque = opaque;
    options.shade = x;
    *plain = exp(-x * (double)depth);
    *ours = stability_look(&scene, &light, &options, shape_dvec3_make(0, 9, 0), shape_dvec3_make(0, -1, 0));
    shape_opaque_destroy(opaque);
    sample_end(&scene);
}

/* --- growing steps and long ways --- */

/* z_(k+1) = (1 + share) z_k from the eye itself, a million times. */
static void steps_from_the_eye(double x, double *plain, double *ours)
{
    (void)x;
    const double share = 0.01;
    sample_scene scene = stability_ball(2, 0.5, 0);
    shape_light light = stability_white_sky();
    shape_march_options options = shape_march_defaults();
    double z = 0, depth = 0;
    for (int k = 0; k < 1000000 && z < 2; k++) {
        double next = z * (1 + share);
        depth += 0.5 * (next - z);
        z = next;
    }
    *plain = depth / 1;
    options.light = SHAPE_MARCH_SINGLE;
    options.stepping = SHAPE_STEP_EXPONENTIAL;
    options.share = share;
    *ours =
        -log(stability_look(&scene, &light, &options, shape_dvec3_make(0, 0, 0), shape_dvec3_make(0, 0, -1)));
    sample_end(&scene);
}

/* A ball of 20 m, 10,000 km away, by steps of 0.1 m: t + 0.1 is t in single precision. */
static void steps_far_away(double x, double *plain, double *ours)
{
    (void)x;
    const double far = 1e7, radius = 20, sigma = 0.05;
    sample_scene scene = stability_ball(radius, sigma, 0);
    shape_light light = stability_white_sky();
    shape_march_options options = shape_march_defaults();
    float t = (float)(far - radius), end = (float)(far + radius);
    float first = t;
    for (int k = 0; k < 1000000 && t < end; k++)
        t += 0.1f;
    *plain = (double)(t - first) / (2 * radius);
    options.light = SHAPE_MARCH_SINGLE;
    options.step = 0.1;
    double seen =
        stability_look(&scene, &light, &options, shape_dvec3_make(0, 0, far), shape_dvec3_make(0, 0, -1));
    *ours = -log(seen) / (2 * radius * sigma);
    sample_end(&scene);
}

#define RULE "largest departure of the light from a source of 1, steps of depth 0.01 to 100"
#define EXPONENTIAL "default rule `exponential`: each step solved as if uniform, (1 - exp(-x)) J"

static const stability_row rows[] = {
    {"step of optical depth 0.01 to 100, `riemann-left`", "energy above 1: x / (1 - exp(-x))", EXPONENTIAL,
     RULE, 1 - 1e-6, 1 + 1e-6, measure_rule, SHAPE_RULE_RIEMANN_LEFT},
    {"the same, `riemann-right`", "all light is lost: x / (exp(x) - 1)", EXPONENTIAL, RULE, 1 - 1e-6,
     1 + 1e-6, measure_rule, SHAPE_RULE_RIEMANN_RIGHT},
    {"the same, `trapezoid`", "energy above 1: near x / 2", EXPONENTIAL, RULE, 1 - 1e-6, 1 + 1e-6,
     measure_rule, SHAPE_RULE_TRAPEZOID},
    {"the same, `simpson`", "energy above 1: near x / 6 of a panel", EXPONENTIAL, RULE, 1 - 1e-6, 1 + 1e-6,
     measure_rule, SHAPE_RULE_SIMPSON},
    {"the same, `simpson38`", "energy above 1: near x / 8 of a panel", EXPONENTIAL, RULE, 1 - 1e-6, 1 + 1e-6,
     measure_rule, SHAPE_RULE_SIMPSON38},
    {"five steps of depth 1.5 by 1 - x for exp(-x) (Jiménez Eq. 12, 13)", "negative transmittance",
     "exp(-x) everywhere, also in `paper`", "transmittance", 0, 1, one_minus_x, 1.5},
    {"five steps of depth 10 the same way", "grows without bound, with either sign", "exp(-x)",
     "transmittance", 0, 1, one_minus_x, 10},
    {"whole steps of 0.1 m, sigma 5/m (Jiménez Algorithm 1)",
     "the last step overhangs: rings where their number changes, each sigma ds deep",
     "steps are stretched to fill the interval", "largest change of optical depth to the neighbouring ray", 0,
     0.05, whole_steps, 0},
    {"opaque thing behind depth 25, long steps",
     "`--step-end adapt` (Páleník Eq. 4.1, 4.2): its shape shows, as a negative",
     "`--step-end cut` (default): steps stay where they were", "radiance over that without the thing",
     1 - 1e-6, 1 + 1e-6, occluder, 0},
    {"shadow of an opaque thing, `--shade 0`", "0 times an infinite depth", "what is opaque stays so",
     "light in the shadow", 0, 0, shaded_shadow, 0},
    {"exponential steps from an eye inside the cloud", "z (1 + h) from z = 0 never moves",
     "one fixed step, then growing ones", "optical depth found, of 1", 0.999, 1.001, steps_from_the_eye, 0},
    {"t += 0.1 m, 10,000 km away", "stands still in single precision",
     "ends of steps from their number, not by adding", "length found over the truth", 0.95, 1.05,
     steps_far_away, 0},
};

const stability_part stability_steps = {"Steps", rows, sizeof rows / sizeof *rows};
