/* The 3-D Gaussian cumulus (Jiménez 2018 section 3.6.1): Table 2's clamped normal positions, the radii of Eq. 15 and
 * 16, hollowing, and containment pruning (Eq. 17, primitive/prune.c). */
#include "shape/gaussian.h"

#include "shape/prune.h"

enum { STREAM_SPHERES = 0 };

shape_gaussian shape_gaussian_defaults(void)
{
    shape_gaussian options = {.count = 35,
                              .sigma = {3.8, 1.7, 3.7},
                              .clamp = 2,
                              .clamp_mode = SHAPE_CLAMP_EDGE,
                              .radius_law = SHAPE_RADIUS_GAUSSIAN,
                              .max_radius = 2.9,
                              .hollow = true,
                              .prune = true};
    return options;
}

static shape_status out_of_range(const char *what, double value, const char *range, shape_error *error)
{
    return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "%s is %g (it must be %s)", what, value, range);
}

shape_status shape_gaussian_check(const shape_gaussian *options, shape_error *error)
{
    static const char *const means[] = {"mean x", "mean y", "mean z"};
    static const char *const sigmas[] = {"sigma x", "sigma y", "sigma z"};
    if (options->count < 1 || options->count > SHAPE_GAUSSIAN_MAX_COUNT)
        return out_of_range("count", (double)options->count, "1 to 10000000", error);
    for (int i = 0; i < 3; i++) {
        if (!(fabs(options->mean[i]) <= 1e6))
            return out_of_range(means[i], options->mean[i], "-1e6 to 1e6", error);
        if (!(options->sigma[i] >= 0 && options->sigma[i] <= 1e6))
            return out_of_range(sigmas[i], options->sigma[i], "0 to 1e6", error);
    }
    if (!(options->clamp >= 0.01 && options->clamp <= 10))
        return out_of_range("clamp", options->clamp, "0.01 to 10", error);
    if (options->clamp_mode != SHAPE_CLAMP_EDGE && options->clamp_mode != SHAPE_CLAMP_REJECT)
        return out_of_range("the clamp mode", options->clamp_mode, "edge or reject", error);
    if (options->radius_law != SHAPE_RADIUS_INVERSE && options->radius_law != SHAPE_RADIUS_GAUSSIAN)
        return out_of_range("the radius law", options->radius_law, "inverse or gaussian", error);
    if (!(options->max_radius >= 1e-6 && options->max_radius <= 1e6))
        return out_of_range("max-radius", options->max_radius, "1e-6 to 1e6", error);
    return SHAPE_OK;
}

/* A standard normal draw kept to low..high in the way that mode says. */
static double clamped_normal(double low, double high, shape_clamp_mode mode, shape_random *random)
{
    double value = shape_random_normal(random);
    while (mode == SHAPE_CLAMP_REJECT && (value < low || value > high))
        value = shape_random_normal(random);
    return value < low ? low : value > high ? high : value;
}

shape_dvec3 shape_gaussian_point(const shape_gaussian *options, shape_random *random)
{
    double k = options->clamp;
    double x = clamped_normal(-k, k, options->clamp_mode, random);
    double y = clamped_normal(0, k, options->clamp_mode, random);
    double z = clamped_normal(-k, k, options->clamp_mode, random);
    return shape_dvec3_make(options->sigma[0] * x, options->sigma[1] * y, options->sigma[2] * z);
}

double shape_gaussian_radius(const shape_gaussian *options, shape_dvec3 from_mean)
{
    if (options->radius_law == SHAPE_RADIUS_INVERSE)
        return options->max_radius / (fabs(from_mean.x) + fabs(from_mean.z) + 1);
    const double offset[3] = {from_mean.x, from_mean.y, from_mean.z};
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        double term = options->sigma[i] > 0 ? offset[i] / (2 * options->sigma[i]) : 0;
        sum += term * term;
    }
    return options->max_radius * (1 - 0.1 * sqrt(sum));
}

bool shape_gaussian_in_core(const shape_gaussian *options, shape_dvec3 from_mean)
{
    return fabs(from_mean.x) < 0.75 * options->sigma[0] && fabs(from_mean.y) < options->sigma[1] / 3 &&
           fabs(from_mean.z) < 0.75 * options->sigma[2];
}

/* Draws the spheres; returns how many the core took. The list has room. */
static size_t draw(const shape_gaussian *options, bool hollow, shape_random random, shape_primitives *list)
{
    size_t hollowed = 0;
    for (size_t i = 0; i < options->count; i++) {
        shape_dvec3 p = shape_gaussian_point(options, &random);
        if (hollow && shape_gaussian_in_core(options, p)) {
            hollowed++;
            continue;
        }
        shape_sphere sphere = {(float)(options->mean[0] + p.x), (float)(options->mean[1] + p.y),
                               (float)(options->mean[2] + p.z), (float)shape_gaussian_radius(options, p)};
        list->spheres[list->sphere_count++] = sphere;
    }
    return hollowed;
}

shape_status shape_gaussian_make(const shape_gaussian *options, uint64_t seed, shape_primitives *list,
                                 shape_gaussian_report *report, shape_error *error)
{
    shape_status status = shape_gaussian_check(options, error);
    if (status)
        return status;
    if (shape_primitives_count(list))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "a cumulus needs an empty list");
    status = shape_primitives_reserve(list, options->count, 0, error);
    if (status)
        return status;
    shape_gaussian_report result = {.drawn = options->count};
    shape_random random = shape_random_seed(seed, STREAM_SPHERES);
    result.hollowed = draw(options, options->hollow, random, list);
    if (!list->sphere_count) /* a cloud of core alone stays whole */
        result.hollowed = draw(options, false, random, list);
    if (options->prune)
        status = shape_primitives_prune(list, &result.pruned, error);
    if (report)
        *report = result;
    return status;
}

uint64_t shape_field_seed(uint64_t seed, uint64_t index)
{
    return index ? shape_hash(shape_hash(seed) + index) : seed;
}

shape_gaussian shape_gaussian_species(shape_species species)
{
    static const struct {
        size_t count;
        double sigma[3], max_radius;
    } table[] = {
        [SHAPE_SPECIES_HUMILIS] = {45, {2.3, 0.45, 2.2}, 1.7},
        [SHAPE_SPECIES_MEDIOCRIS] = {70, {2.6, 5.0, 2.6}, 2.8},
        [SHAPE_SPECIES_CONGESTUS] = {160, {2.3, 8.0, 2.3}, 2.6},
    };
    shape_gaussian options = shape_gaussian_defaults();
    options.count = table[species].count;
    for (int i = 0; i < 3; i++)
        options.sigma[i] = table[species].sigma[i];
    options.max_radius = table[species].max_radius;
    return options;
}
