/* A few hundred of a picture's rays stand for the picture: what settings cost and miss is measured on them. */
#include <math.h>
#include <string.h>

#include "budget/view.h"
#include "shape/imageerror.h"

shape_status shape_budget_change(const float *picture, const float *reference, int width, int height,
                                 double *change, shape_error *error)
{
    shape_imageerror measured;
    shape_status status = shape_imageerror_measure(picture, reference, width, height, &measured, error);
    *change = status ? 0 : sqrt(measured.relmse);
    return status;
}

/* The middle of pixel number i of the sequence; small pictures are gone through once. */
static void pick(const shape_view *view, int i, int tries, double *x, double *y)
{
    long pixels = (long)view->width * view->height;
    if (pixels > 0 && pixels <= tries) {
        /* A step without a common divisor visits each pixel once, in an order that is spread over the picture. */
        long step = (long)(0.6180339887498949 * (double)pixels) | 1, a, b, rest;
        for (;; step += 2) {
            for (a = step, b = pixels; b; rest = a % b, a = b, b = rest)
                ;
            if (a == 1)
                break;
        }
        long at = (long)((long long)i * step % pixels);
        *x = (double)(at % view->width) + 0.5;
        *y = (double)(at / view->width) + 0.5;
        return;
    }
    double u = 0.5 + 0.7548776662466927 * i, v = 0.5 + 0.5698402909980532 * i;
    *x = floor((u - floor(u)) * view->width) + 0.5;
    *y = floor((v - floor(v)) * view->height) + 0.5;
}

shape_status probe_open(probe *p, const shape_marcher *marcher, const shape_view *view, shape_error *error)
{
    shape_camera camera = shape_view_camera(view);
    shape_march_scratch scratch;
    shape_status status = SHAPE_OK;
    long pixels = (long)view->width * view->height;
    int tries = pixels < PROBE_TRIES ? (int)pixels : PROBE_TRIES;
    memset(p, 0, sizeof *p);
    memset(&scratch, 0, sizeof scratch);
    p->view = view;
    p->eye = camera.origin;
    while (p->tries < tries && p->rays < PROBE_RAYS && !status) {
        double x, y;
        size_t count;
        pick(view, p->tries++, tries, &x, &y);
        shape_dvec3 d = shape_camera_direction(&camera, view, x, y);
        status = march_path_find(marcher, &scratch.view, p->eye, d, false, &count, error);
        if (!status && count)
            p->directions[p->rays++] = d;
    }
    shape_march_scratch_free(&scratch);
    return status;
}

shape_status probe_march(probe *p, const shape_marcher *marcher, probe_picture *picture, shape_error *error)
{
    shape_status status = SHAPE_OK;
    uint64_t looks = 0;
#pragma omp parallel reduction(+ : looks)
    {
        shape_march_scratch scratch;
        shape_status own = SHAPE_OK;
        memset(&scratch, 0, sizeof scratch);
#pragma omp for schedule(dynamic, 8)
        for (int i = 0; i < p->rays; i++)
            if (!own)
                own = shape_march_radiance(marcher, p->eye, p->directions[i], 0, &scratch,
                                           picture->rgb + 3 * i, NULL);
        looks += scratch.looks;
        shape_march_scratch_free(&scratch);
        if (own) {
#pragma omp critical
            status = own;
        }
    }
    p->work.looks += looks;
    return status ? shape_error_memory(error) : SHAPE_OK;
}

double probe_change(const probe *p, const probe_picture *picture, const probe_picture *reference)
{
    double sum = 0;
    for (int i = 0; i < p->rays; i++)
        for (int c = 0; c < 3; c++) {
            double b = reference->rgb[3 * i + c], off = picture->rgb[3 * i + c] - b;
            sum += off * off / (b * b + SHAPE_IMAGEERROR_EPSILON);
        }
    return p->tries ? sqrt(sum / (3.0 * p->tries)) : 0;
}
