/* The soft union of ellipsoids over a lattice, and its gradient. A surface is 2 width thick; across it o rises from 0 to 1
 * as a cubic of the distance, (1 - u) / |grad u| to first order. Union: 1 - product of (1 - o_i). */
#include <math.h>
#include <string.h>

#include "generate/volumefit_private.h"

/* 1 - o never falls below this, so that a factor can be taken out of the product again. */
static const double least_left = 1e-3;

fit_primitive fit_ball(const double centre[3], double radius)
{
    fit_primitive p;
    memset(&p, 0, sizeof p);
    memcpy(p.value, centre, 3 * sizeof *centre);
    for (int i = 0; i < 3; i++)
        p.value[3 + 4 * i] = 1 / radius;
    return p;
}

/* Cofactors of m, and its determinant. */
static double invert(const double *m, double inverse[9])
{
    double det = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            inverse[3 * i + j] = m[3 * a + c] * m[3 * b + d] - m[3 * a + d] * m[3 * b + c];
        }
    for (int j = 0; j < 3; j++)
        det += m[j] * inverse[3 * j];
    for (int i = 0; i < 9; i++)
        inverse[i] /= det;
    return det;
}

static double frobenius(const double *m)
{
    double sum = 0;
    for (int i = 0; i < 9; i++)
        sum += m[i] * m[i];
    return sqrt(sum);
}

/* A bound of the largest stretch of m, which is 1 / the smallest semi-axis: the lesser of two norms (Golub and Van Loan,
 * Matrix Computations, 2.3). */
static double largest_stretch(const double *m)
{
    double rows = 0, columns = 0;
    for (int i = 0; i < 3; i++) {
        rows = fmax(rows, fabs(m[3 * i]) + fabs(m[3 * i + 1]) + fabs(m[3 * i + 2]));
        columns = fmax(columns, fabs(m[i]) + fabs(m[3 + i]) + fabs(m[6 + i]));
    }
    return fmin(frobenius(m), sqrt(rows * columns)) * (1 + 1e-9);
}

static void prepare(fit_primitive *p, const fit_lattice *lattice, double width)
{
    double inverse[9], det = invert(p->value + 3, inverse), stretch = largest_stretch(p->value + 3);
    p->radius = cbrt(1 / fabs(det));
    double inner = fmax(1 - width * stretch, 0), outer = 1 + width * stretch;
    p->inner2 = inner * inner;
    p->outer2 = outer * outer;
    for (int a = 0; a < 3; a++) {
        double half = width + 0.5;
        half += sqrt(inverse[3 * a] * inverse[3 * a] + inverse[3 * a + 1] * inverse[3 * a + 1] +
                     inverse[3 * a + 2] * inverse[3 * a + 2]);
        double low = floor(p->value[a] - half), high = ceil(p->value[a] + half), last = lattice->n[a] - 1;
        p->low[a] = (int)fmin(fmax(low, 0), last + 1);
        p->high[a] = (int)fmax(fmin(high, last), -1);
    }
}

/* At one point: how far across the surface q (0 outside to 1 inside), and what its gradient needs. */
typedef struct crossing {
    double q, u, gradient; /* gradient: |grad u| */
    double d[3], v[3], w[3];
} crossing;

static inline bool cross(const fit_primitive *p, double width, double x, double y, double z, crossing *c)
{
    const double *m = p->value + 3;
    double d0 = x - p->value[0], d1 = y - p->value[1], d2 = z - p->value[2];
    double v0 = m[0] * d0 + m[1] * d1 + m[2] * d2, v1 = m[3] * d0 + m[4] * d1 + m[5] * d2,
           v2 = m[6] * d0 + m[7] * d1 + m[8] * d2, u2 = v0 * v0 + v1 * v1 + v2 * v2;
    c->q = u2 <= p->inner2;
    if (u2 >= p->outer2 || u2 < p->inner2)
        return false;
    double w0 = m[0] * v0 + m[3] * v1 + m[6] * v2, w1 = m[1] * v0 + m[4] * v1 + m[7] * v2,
           w2 = m[2] * v0 + m[5] * v1 + m[8] * v2, ww = w0 * w0 + w1 * w1 + w2 * w2;
    if (!(ww > 0)) {
        c->q = 1;
        return false;
    }
    double u = sqrt(u2), gradient = sqrt(ww) / u, s = (1 - u) / (gradient * width);
    if (!(s > -1 && s < 1)) {
        c->q = s > 0;
        return false;
    }
    *c = (crossing){0.5 * (s + 1), u, gradient, {d0, d1, d2}, {v0, v1, v2}, {w0, w1, w2}};
    return true;
}

/* The cells of a row in which u^2 may be below a limit. False where there are none. */
static bool row_span(const fit_primitive *p, double limit2, int y, int z, int *first, int *last)
{
    const double *m = p->value + 3;
    double d1 = y + 0.5 - p->value[1], d2 = z + 0.5 - p->value[2], a = 0, b = 0, c = -limit2;
    for (int i = 0; i < 3; i++) {
        double rest = m[3 * i + 1] * d1 + m[3 * i + 2] * d2;
        a += m[3 * i] * m[3 * i];
        b += m[3 * i] * rest;
        c += rest * rest;
    }
    double room = b * b - a * c;
    if (!(room > 0 && a > 0))
        return false;
    double half = sqrt(room) / a, middle = p->value[0] - b / a - 0.5;
    *first = (int)fmin(fmax(ceil(middle - half), p->low[0]), p->high[0] + 1);
    *last = (int)fmax(fmin(floor(middle + half), p->high[0]), p->low[0] - 1);
    return *first <= *last;
}

static inline double left_of(const crossing *c)
{
    double left = 1 - c->q * c->q * (3 - 2 * c->q);
    return left > least_left ? left : least_left;
}

static inline size_t cell_index(const fit_lattice *l, int x, int y, int z)
{
    return ((size_t)z * (size_t)l->n[1] + (size_t)y) * (size_t)l->n[0] + (size_t)x;
}

static void fill_row(fit_union *u, const fit_primitive *p, int y, int z)
{
    int from, to, in_from, in_to;
    crossing c;
    if (!row_span(p, p->outer2, y, z, &from, &to))
        return;
    if (!row_span(p, p->inner2, y, z, &in_from, &in_to))
        in_from = in_to = to;
    float *row = &u->left[cell_index(u->lattice, 0, y, z)];
    for (int x = from; x <= to; x++) {
        bool inside = x > in_from && x < in_to;
        if (!inside)
            cross(p, u->width, x + 0.5, y + 0.5, z + 0.5, &c);
        if (inside || c.q > 0)
            row[x] = fmaxf(row[x] * (float)(inside ? least_left : left_of(&c)), 1e-30f);
    }
}

static void fill_slice(fit_union *u, int z)
{
    const fit_lattice *l = u->lattice;
    size_t first = cell_index(l, 0, 0, z), size = (size_t)l->n[0] * (size_t)l->n[1];
    for (size_t i = 0; i < size; i++)
        u->left[first + i] = 1;
    for (size_t i = 0; i < u->count; i++) {
        const fit_primitive *p = &u->items[i];
        if (z < p->low[2] || z > p->high[2])
            continue;
        for (int y = p->low[1]; y <= p->high[1]; y++)
            fill_row(u, p, y, z);
    }
}

void fit_union_fill(fit_union *u)
{
    for (size_t i = 0; i < u->count; i++)
        prepare(&u->items[i], u->lattice, u->width);
#pragma omp parallel for schedule(dynamic, 1)
    for (int z = 0; z < u->lattice->n[2]; z++)
        fill_slice(u, z);
}

/* With O = 1 - left, the loss (O - T)^2 has dLoss/do_i = 2 (O - T) left / (1 - o_i). */
static void gather(const fit_union *u, fit_primitive *p)
{
    const fit_lattice *l = u->lattice;
    double *g = p->gradient;
    crossing c;
    memset(g, 0, sizeof p->gradient);
    for (int z = p->low[2]; z <= p->high[2]; z++)
        for (int y = p->low[1]; y <= p->high[1]; y++) {
            int from, to, in_from, in_to;
            if (!row_span(p, p->outer2, y, z, &from, &to))
                continue;
            if (!row_span(p, p->inner2, y, z, &in_from, &in_to))
                in_from = in_to = to;
            for (int x = from; x <= to; x++) {
                if (x == in_from + 1 && x < in_to)
                    x = in_to; /* plainly inside: no gradient there */
                if (!cross(p, u->width, x + 0.5, y + 0.5, z + 0.5, &c))
                    continue;
                size_t i = cell_index(l, x, y, z);
                double left = (double)u->left[i], miss = 1 - left - (double)l->target[i];
                double by_o = 2 * miss * left / left_of(&c);
                double by_u = by_o * 3 * c.q * (1 - c.q) * -1 / (c.gradient * u->width * c.u);
                for (int a = 0; a < 3; a++) {
                    g[a] -= by_u * c.w[a];
                    for (int b = 0; b < 3; b++)
                        g[3 + 3 * a + b] += by_u * c.v[a] * c.d[b];
                }
            }
        }
}

void fit_union_gradients(fit_union *u)
{
#pragma omp parallel for schedule(dynamic, 1)
    for (size_t i = 0; i < u->count; i++)
        gather(u, &u->items[i]);
}

double fit_union_use(const fit_union *u, size_t item)
{
    const fit_lattice *l = u->lattice;
    const fit_primitive *p = &u->items[item];
    double sum = 0;
    crossing c;
    for (int z = p->low[2]; z <= p->high[2]; z++)
        for (int y = p->low[1]; y <= p->high[1]; y++) {
            int from, to;
            if (!row_span(p, p->outer2, y, z, &from, &to))
                continue;
            for (int x = from; x <= to; x++) {
                cross(p, u->width, x + 0.5, y + 0.5, z + 0.5, &c);
                if (!(c.q > 0))
                    continue;
                size_t i = cell_index(l, x, y, z);
                double left = (double)u->left[i], without = fmin(left / left_of(&c), 1);
                double miss = 1 - left - (double)l->target[i], then = 1 - without - (double)l->target[i];
                sum += then * then - miss * miss;
            }
        }
    return sum;
}

/* Adam (Kingma and Ba 2015), each number in units of its own: places by the radius, m by 1 / radius. */
void fit_union_step(fit_union *u, double rate)
{
    const double keep_mean = 0.85, keep_square = 0.97;
    for (size_t i = 0; i < u->count; i++) {
        fit_primitive *p = &u->items[i];
        double old[12], inverse[9];
        memcpy(old, p->value, sizeof old);
        p->steps++;
        double mean_bias = 1 - pow(keep_mean, p->steps), square_bias = 1 - pow(keep_square, p->steps);
        double size = frobenius(p->value + 3) / 1.7320508;
        for (int k = 0; k < 12; k++) {
            double unit = k < 3 ? 1 / size : size, g = p->gradient[k] * unit;
            p->mean[k] = keep_mean * p->mean[k] + (1 - keep_mean) * g;
            p->square[k] = keep_square * p->square[k] + (1 - keep_square) * g * g;
            p->value[k] -= rate * unit * (p->mean[k] / mean_bias) / (sqrt(p->square[k] / square_bias) + 1e-6);
        }
        /* Not flatter than half a cell, and never turned inside out. */
        double det = invert(p->value + 3, inverse);
        if (!isfinite(det) || !(fabs(det) > 1e-12) || frobenius(p->value + 3) > 4)
            memcpy(p->value, old, sizeof old);
    }
}
