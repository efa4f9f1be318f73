/* Metaball cumuli (Jiménez 2018 section 3.6.3, Fig. 13): positions as in gaussian.c, radii drawn at random. */
#include "shape/metaball.h"

#include "shape/gaussian.h"

enum { STREAM_BALLS = 2, MAX_COUNT = 100000 };

shape_metaball shape_metaball_defaults(void)
{
    shape_metaball options = {.count = 6, .sigma = {3.6, 1.5, 2.8}, .min_radius = 1.25, .max_radius = 2.5};
    return options;
}

static shape_status out_of_range(const char *what, double value, const char *range, shape_error *error)
{
    return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "%s is %g (it must be %s)", what, value, range);
}

shape_status shape_metaball_check(const shape_metaball *options, shape_error *error)
{
    static const char *const sigmas[] = {"sigma x", "sigma y", "sigma z"};
    if (options->count < 1 || options->count > MAX_COUNT)
        return out_of_range("count", (double)options->count, "1 to 100000", error);
    for (int i = 0; i < 3; i++)
        if (!(options->sigma[i] >= 0 && options->sigma[i] <= 1e6))
            return out_of_range(sigmas[i], options->sigma[i], "0 to 1e6", error);
    if (!(options->max_radius >= 1e-6 && options->max_radius <= 1e6))
        return out_of_range("max-radius", options->max_radius, "1e-6 to 1e6", error);
    if (!(options->min_radius >= 1e-6 && options->min_radius <= options->max_radius))
        return out_of_range("min-radius", options->min_radius, "1e-6 to max-radius", error);
    return SHAPE_OK;
}

shape_status shape_metaball_make(const shape_metaball *options, uint64_t seed, shape_primitives *list,
                                 shape_error *error)
{
    shape_status status = shape_metaball_check(options, error);
    if (status)
        return status;
    if (shape_primitives_count(list))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "a metaball cloud needs an empty list");
    shape_gaussian places = shape_gaussian_defaults();
    for (int i = 0; i < 3; i++)
        places.sigma[i] = options->sigma[i];
    shape_random random = shape_random_seed(seed, STREAM_BALLS);
    for (size_t i = 0; i < options->count && !status; i++) {
        shape_dvec3 p = shape_gaussian_point(&places, &random);
        double radius = shape_random_range(&random, options->min_radius, options->max_radius);
        shape_sphere ball = {(float)p.x, (float)p.y, (float)p.z, (float)radius};
        status = shape_primitives_add_sphere(list, ball, error);
    }
    return status;
}
