/* The rules of integration (Páleník 2016 section 4.1) for the pair of integrals along a ray: depth' = extinction and
 * radiance' = exp(-depth) added. Inside a panel the depth is interpolated to the rule's own order, so that Simpson's
 * rules keep order 4 (with the trapezoid rule for the depth, as in Eq. 4.9, they fall to 2). */
#include "light/march.h"

#include <math.h>

int march_panel_steps(shape_rule rule)
{
    return rule == SHAPE_RULE_SIMPSON ? 2 : rule == SHAPE_RULE_SIMPSON38 ? 3 : 1;
}

static void add(march_ray *ray, const march_sample *sample, double depth, double weight)
{
    if (!(sample->added[0] > 0 || sample->added[1] > 0 || sample->added[2] > 0))
        return;
    double factor = weight * exp(-depth);
    for (int c = 0; c < 3; c++)
        ray->rgb[c] += factor * sample->added[c];
}

/* A polynomial through the samples may dip where the density jumps; depth never does. */
static double between(double low, double x, double high)
{
    return x < low ? low : x > high ? high : x;
}

static void simpson(march_ray *ray, float a, float b)
{
    march_sample f[3] = {march_look(ray, a), march_look(ray, a + (b - a) / 2), march_look(ray, b)};
    double width = (double)b - (double)a, start = ray->depth;
    double end = start + width / 6 * (f[0].extinction + 4 * f[1].extinction + f[2].extinction);
    double middle = start + width / 24 * (5 * f[0].extinction + 8 * f[1].extinction - f[2].extinction);
    add(ray, &f[0], start, width / 6);
    add(ray, &f[1], between(start, middle, end), width * 4 / 6);
    add(ray, &f[2], end, width / 6);
    ray->depth = end;
}

static void simpson38(march_ray *ray, float a, float b)
{
    march_sample f[4];
    for (int i = 0; i < 4; i++)
        f[i] = march_look(ray, i < 3 ? a + (b - a) * (float)i / 3 : b);
    double s = ((double)b - (double)a) / 3, start = ray->depth;
    double x[4] = {f[0].extinction, f[1].extinction, f[2].extinction, f[3].extinction};
    double end = start + 3 * s / 8 * (x[0] + 3 * x[1] + 3 * x[2] + x[3]);
    double first = start + s / 24 * (9 * x[0] + 19 * x[1] - 5 * x[2] + x[3]);
    double second = start + s / 3 * (x[0] + 4 * x[1] + x[2]);
    add(ray, &f[0], start, 3 * s / 8);
    add(ray, &f[1], between(start, first, end), 9 * s / 8);
    add(ray, &f[2], between(start, second, end), 9 * s / 8);
    add(ray, &f[3], end, 3 * s / 8);
    ray->depth = end;
}

static void exponential(march_ray *ray, float a, float b)
{
    double width = (double)b - (double)a;
    ray->width = width;
    march_sample f = march_look(ray, a + (b - a) * 0.5f);
    double step = f.extinction * width;
    /* A cloud that only glows has no depth. */
    if (!(step > 0)) {
        add(ray, &f, ray->depth, width);
        return;
    }
    add(ray, &f, ray->depth, -expm1(-step) / f.extinction);
    ray->depth += step;
}

void march_panel(march_ray *ray, shape_rule rule, float a, float b)
{
    double width = (double)b - (double)a;
    march_sample f, g;
    switch (rule) {
    case SHAPE_RULE_RIEMANN_LEFT:
        f = march_look(ray, a);
        add(ray, &f, ray->depth, width);
        ray->depth += width * f.extinction;
        return;
    case SHAPE_RULE_RIEMANN_RIGHT:
        f = march_look(ray, b);
        ray->depth += width * f.extinction;
        add(ray, &f, ray->depth, width);
        return;
    case SHAPE_RULE_TRAPEZOID:
        f = march_look(ray, a);
        g = march_look(ray, b);
        add(ray, &f, ray->depth, width / 2);
        ray->depth += width / 2 * (f.extinction + g.extinction);
        add(ray, &g, ray->depth, width / 2);
        return;
    case SHAPE_RULE_SIMPSON:
        simpson(ray, a, b);
        return;
    case SHAPE_RULE_SIMPSON38:
        simpson38(ray, a, b);
        return;
    case SHAPE_RULE_EXPONENTIAL:
        exponential(ray, a, b);
        return;
    }
}
