/* One shape for two. Moments of solid ellipsoids: the covariance of a uniform one is A A^T / 5, A its semi-axes as
 * columns; of a mixture it is the mean of the parts' and of the centres' (as in Goldberger and Roweis 2005's hierarchy of
 * Gaussian mixtures). */
#include "budget/pair.h"

#include "primitive/axes.h"
#include "shape/random.h"

budget_ball budget_ball_make(void)
{
    budget_ball ball;
    shape_random random = shape_random_seed(1, 0x73696d70);
    for (int i = 0; i < BUDGET_SAMPLES;) {
        /* Shells of equal volume in turn, so that rim and core both have their share. */
        shape_dvec3 p = {shape_random_range(&random, -1, 1), shape_random_range(&random, -1, 1),
                         shape_random_range(&random, -1, 1)};
        double square = shape_dvec3_dot(p, p), low = (double)i / BUDGET_SAMPLES,
               high = (double)(i + 1) / BUDGET_SAMPLES;
        double cube = square * sqrt(square);
        if (cube >= low && cube < high)
            ball.points[i++] = p;
    }
    return ball;
}

static double determinant(const shape_dvec3 m[3])
{
    return shape_dvec3_dot(m[0], shape_dvec3_cross(m[1], m[2]));
}

/* Volumes are in units of the unit ball's. */
static void complete(budget_shape *shape)
{
    shape->volume = fabs(determinant(shape->axes));
    for (int k = 0; k < 3; k++)
        shape->rows[k] =
            shape_dvec3_scale(shape->axes[k], 1 / shape_dvec3_dot(shape->axes[k], shape->axes[k]));
}

budget_shape budget_shape_of(const shape_primitives *list, size_t number)
{
    shape_ellipsoid e = number < list->sphere_count ? shape_axes_sphere(&list->spheres[number])
                                                    : list->ellipsoids[number - list->sphere_count];
    budget_shape shape = {.centre = {e.x, e.y, e.z}};
    shape_axes_of(&e, shape.axes);
    complete(&shape);
    return shape;
}

shape_dvec3 budget_shape_point(const budget_shape *shape, shape_dvec3 ball)
{
    shape_dvec3 p = shape->centre;
    p = shape_dvec3_add(p, shape_dvec3_scale(shape->axes[0], ball.x));
    p = shape_dvec3_add(p, shape_dvec3_scale(shape->axes[1], ball.y));
    return shape_dvec3_add(p, shape_dvec3_scale(shape->axes[2], ball.z));
}

double budget_shape_u2(const budget_shape *shape, shape_dvec3 p)
{
    shape_dvec3 d = shape_dvec3_sub(p, shape->centre);
    double x = shape_dvec3_dot(shape->rows[0], d), y = shape_dvec3_dot(shape->rows[1], d),
           z = shape_dvec3_dot(shape->rows[2], d);
    return x * x + y * y + z * z;
}

/* The volume that two have in common: the mean of both estimates. */
static double common_volume(const budget_shape *a, const budget_shape *b, const budget_ball *ball)
{
    int in_b = 0, in_a = 0;
    for (int i = 0; i < BUDGET_SAMPLES; i++) {
        in_b += budget_shape_u2(b, budget_shape_point(a, ball->points[i])) <= 1;
        in_a += budget_shape_u2(a, budget_shape_point(b, ball->points[i])) <= 1;
    }
    double common = 0.5 * (in_b * a->volume + in_a * b->volume) / BUDGET_SAMPLES;
    double most = a->volume < b->volume ? a->volume : b->volume;
    return common < most ? common : most;
}

typedef struct symmetric {
    double m[3][3];
} symmetric;

static void add_outer(symmetric *s, shape_dvec3 v, double weight)
{
    const double c[3] = {v.x, v.y, v.z};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            s->m[i][j] += weight * c[i] * c[j];
}

/* A square root by Cholesky's decomposition, made of perpendicular columns afterwards; false where there is none. */
static bool axes_from_covariance(const symmetric *s, shape_dvec3 axes[3])
{
    double l[3][3] = {{0}};
    for (int j = 0; j < 3; j++)
        for (int i = j; i < 3; i++) {
            double sum = s->m[i][j];
            for (int k = 0; k < j; k++)
                sum -= l[i][k] * l[j][k];
            if (i == j && !(sum > 0))
                return false;
            l[i][j] = i == j ? sqrt(sum) : sum / l[j][j];
        }
    for (int j = 0; j < 3; j++)
        axes[j] = shape_dvec3_make(l[0][j], l[1][j], l[2][j]);
    shape_axes_diagonalize(axes);
    for (int j = 0; j < 3; j++)
        if (!(shape_dvec3_dot(axes[j], axes[j]) > 0))
            return false;
    return true;
}

/* The real cube root of a positive number, by shape_exp and shape_log. */
static double cube_root(double x)
{
    return shape_exp(shape_log(x) / 3);
}

budget_shape budget_shape_join(const budget_shape *a, const budget_shape *b, const budget_ball *ball)
{
    double common = common_volume(a, b, ball);
    double weight_a = a->volume - common / 2, weight_b = b->volume - common / 2, whole = weight_a + weight_b;
    budget_shape joined = {.centre = shape_dvec3_add(shape_dvec3_scale(a->centre, weight_a / whole),
                                                     shape_dvec3_scale(b->centre, weight_b / whole))};
    symmetric covariance = {{{0}}};
    for (int k = 0; k < 3; k++) {
        add_outer(&covariance, a->axes[k], weight_a / whole);
        add_outer(&covariance, b->axes[k], weight_b / whole);
    }
    add_outer(&covariance, shape_dvec3_sub(a->centre, joined.centre), 5 * weight_a / whole);
    add_outer(&covariance, shape_dvec3_sub(b->centre, joined.centre), 5 * weight_b / whole);
    if (!axes_from_covariance(&covariance, joined.axes))
        return a->volume >= b->volume ? *a : *b;
    double scale = cube_root(whole / fabs(determinant(joined.axes)));
    for (int k = 0; k < 3; k++)
        joined.axes[k] = shape_dvec3_scale(joined.axes[k], scale);
    complete(&joined);
    return joined;
}

budget_shape budget_ball_join(const budget_shape *a, const budget_shape *b, double *cost)
{
    double square_a = cube_root(a->volume), square_b = cube_root(b->volume);
    square_a *= square_a;
    square_b *= square_b;
    double sum = square_a + square_b;
    shape_dvec3 apart = shape_dvec3_sub(a->centre, b->centre);
    budget_shape joined = {.centre = shape_dvec3_add(shape_dvec3_scale(a->centre, square_a / sum),
                                                     shape_dvec3_scale(b->centre, square_b / sum))};
    double radius = sqrt(sum);
    joined.axes[0] = shape_dvec3_make(radius, 0, 0);
    joined.axes[1] = shape_dvec3_make(0, radius, 0);
    joined.axes[2] = shape_dvec3_make(0, 0, radius);
    complete(&joined);
    /* The second moment that is lost (Ward 1963). */
    *cost = square_a * square_b / sum * shape_dvec3_dot(apart, apart);
    return joined;
}

double budget_profile(shape_model model, double u2)
{
    if (model == SHAPE_MODEL_UNIFORM)
        return u2 <= 1 ? 1 : 0;
    double left = (1 - u2) / 0.3; /* a spheroid is full, but for the outer sixth of its radius */
    return left < 0 ? 0 : left > 1 ? 1 : left;
}
