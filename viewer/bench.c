/* A view that moves from frame to frame, measured: --bench. Nothing rests, so nothing is gained by refining a picture. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

#include "cli.h"
#include "shape/file.h"
#include "view.h"

/* One frame. */
typedef struct bench_frame {
    double ms;             /* from its beginning to glFinish */
    double processor_ms;   /* of all threads together meanwhile */
    double steps, fetches; /* a pixel */
    double jump; /* from the frame before: rms of the difference over the mean of both; 0 for the first */
    size_t lit, baked;               /* clouds whose light, or density, has come into use with it */
    size_t light_bytes, baked_bytes; /* of grids that were sent to the GPU for it */
    shape_dvec3 eye, target;
} bench_frame;

typedef struct bench_run {
    bench_frame *frames;
    double started, first_ms; /* the program's start, and from there to the first picture */
    long wrong;               /* values that are no number, infinite or negative */
    size_t pixels;
    float *rgba, *last;
} bench_run;

double view_now_ms(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

double view_processor_ms(void)
{
    struct timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static size_t count_primitives(const shape_volume *volume)
{
    size_t count = 0;
    for (size_t i = 0; i < volume->cloud_count; i++)
        count += shape_primitives_count(volume->clouds[i].list);
    return count;
}

/* Compares a picture with the one before it, which it then replaces. Coverage is not part of it. */
static double find_jump(bench_run *run)
{
    double sum = 0, mean = 0;
    for (size_t i = 0; i < 4 * run->pixels; i++) {
        double now = (double)run->rgba[i], before = (double)run->last[i];
        run->wrong += !(run->rgba[i] >= 0 && run->rgba[i] < INFINITY);
        if (i % 4 == 3)
            continue;
        sum += (now - before) * (now - before);
        mean += 0.5 * (now + before);
    }
    memcpy(run->last, run->rgba, 4 * run->pixels * sizeof *run->last);
    const double values = 3 * (double)run->pixels;
    return sqrt(sum / values) / fmax(mean / values, 1e-9);
}

/* Frame i of n: half a degree further round the target; or, in a flight, straight on through the target and out on its far
 * side, looking ahead. */
static void move_on(shape_view *view, const shape_view *from, const view_bench *plan, int i)
{
    if (!plan->flight) {
        view_orbit(view, 0.5);
        return;
    }
    shape_dvec3 way = shape_dvec3_sub(from->target, from->eye);
    double part = 2 * (double)i / (double)(plan->frames > 1 ? plan->frames - 1 : 1);
    view->eye = shape_dvec3_add(from->eye, shape_dvec3_scale(way, part));
    view->target = shape_dvec3_add(view->eye, way);
}

static shape_status draw_frame(shape_gl_renderer *renderer, const shape_view *view, bench_run *run, int i,
                               shape_error *error)
{
    bench_frame *frame = &run->frames[i];
    shape_gl_costs before = shape_gl_get_costs(renderer);
    double start = view_now_ms(), used = view_processor_ms();
    shape_status status = shape_gl_draw_moving(renderer, view, error);
    if (status)
        return status;
    shape_gl_finish();
    frame->ms = view_now_ms() - start;
    frame->processor_ms = view_processor_ms() - used;
    if (i == 0)
        run->first_ms = start + frame->ms - run->started;
    status = shape_gl_read(renderer, run->rgba, error);
    shape_gl_costs after = shape_gl_get_costs(renderer);
    double jump = find_jump(run);
    frame->jump = i ? jump : 0;
    frame->steps = after.steps_per_pixel;
    frame->fetches = after.fetches_per_pixel;
    frame->lit = after.lit_clouds - before.lit_clouds;
    frame->baked = after.baked_clouds - before.baked_clouds;
    frame->light_bytes = after.light_bytes - before.light_bytes;
    frame->baked_bytes = after.baked_bytes - before.baked_bytes;
    frame->eye = view->eye;
    frame->target = view->target;
    return status;
}

/* The rows, as a file that is there whole or not at all. */
static shape_status write_frames(const char *path, const bench_run *run, int count, shape_error *error)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return shape_error_memory(error);
    fputs("frame,milliseconds,steps,fetches,jump,clouds_lit,clouds_baked,light_bytes,baked_bytes,eye_x,eye_y,"
          "eye_z,"
          "target_x,target_y,target_z\n",
          out);
    for (int i = 0; i < count; i++) {
        const bench_frame *f = &run->frames[i];
        fprintf(out, "%d,%.3f,%.4f,%.4f,%.6f,%zu,%zu,%zu,%zu,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", i, f->ms,
                f->steps, f->fetches, f->jump, f->lit, f->baked, f->light_bytes, f->baked_bytes, f->eye.x,
                f->eye.y, f->eye.z, f->target.x, f->target.y, f->target.z);
    }
    shape_status status = fclose(out) ? shape_error_memory(error) : SHAPE_OK;
    if (!status)
        status = shape_file_write(path, text, size, error);
    free(text);
    return status;
}

static void print_report(const view_job *job, const view_bench *plan, shape_gl_costs costs,
                         const bench_run *run, int count, double *times, double *processor)
{
    double slowest = 0, largest_jump = 0, steps = 0, fetches = 0;
    for (int i = 0; i < count; i++) {
        const bench_frame *f = &run->frames[i];
        times[i] = f->ms;
        processor[i] = f->processor_ms;
        slowest = i || count == 1 ? fmax(slowest, f->ms) : 0; /* the first one makes light and voxels */
        largest_jump = fmax(largest_jump, f->jump);
        steps += f->steps / count;
        fetches += f->fetches / count;
    }
    qsort(times, (size_t)count, sizeof *times, compare_doubles);
    qsort(processor, (size_t)count, sizeof *processor, compare_doubles);
    int p95 = (int)ceil(0.95 * count) - 1;
    struct rusage used = {0};
    getrusage(RUSAGE_SELF, &used);
    const double cpu_ms = 1e3 * (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
                          1e-3 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
    json_t *report = json_pack(
        "{s:s, s:[i,i], s:i, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:{s:f,s:f,s:f,s:f}, s:f, s:f, s:I, s:f, "
        "s:f, s:I, s:I, "
        "s:I, s:I, "
        "s:I, "
        "s:f, s:f, s:I}",
        "method", plan->method, "size", job->view.width, job->view.height, "frames", count, "load_ms",
        job->load_ms + costs.upload_ms, "light_ms", costs.light_ms, "bake_ms", costs.bake_ms,
        "first_picture_ms", run->first_ms, "libraries_ms", plan->libraries_ms, "context_ms", plan->context_ms,
        "first_frame_ms", run->frames[0].ms, "frame_ms", "min", times[0], "median", times[count / 2], "p95",
        times[p95], "max", slowest, "processor_ms_min", processor[0], "processor_ms_median",
        processor[count / 2], "primitives", (json_int_t)count_primitives(job->volume), "steps_per_pixel",
        steps, "fetches_per_pixel", fetches, "clouds_lit", (json_int_t)costs.lit_clouds, "clouds_baked",
        (json_int_t)costs.baked_clouds, "light_bytes", (json_int_t)costs.light_bytes, "baked_bytes",
        (json_int_t)costs.baked_bytes, "wrong_values", (json_int_t)run->wrong, "largest_jump", largest_jump,
        "cpu_ms", cpu_ms, "memory_bytes", (json_int_t)used.ru_maxrss * 1024);
    if (!report || json_dumpf(report, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(6)) ||
        putchar('\n') == EOF)
        cli_fail("standard output: cannot write");
    json_decref(report);
}

shape_status view_bench_run(const view_job *job, shape_gl_renderer *renderer, const view_bench *plan,
                            shape_view *view, shape_error *error)
{
    const int count = plan->frames;
    bench_run run = {.pixels = (size_t)job->view.width * (size_t)job->view.height, .started = plan->started};
    double *times = calloc((size_t)count, sizeof *times);
    double *processor = calloc((size_t)count, sizeof *processor);
    run.frames = calloc((size_t)count, sizeof *run.frames);
    run.rgba = malloc(run.pixels * 4 * sizeof *run.rgba);
    run.last = calloc(run.pixels * 4, sizeof *run.last);
    shape_status status =
        times && processor && run.frames && run.rgba && run.last ? SHAPE_OK : shape_error_memory(error);
    *view = job->view;
    for (int i = 0; i < count && !status; i++) {
        if (i)
            move_on(view, &job->view, plan, i);
        status = draw_frame(renderer, view, &run, i, error);
        cli_progress("drawing", (double)(i + 1) / count);
    }
    if (!status && plan->frames_file)
        status = write_frames(plan->frames_file, &run, count, error);
    if (!status)
        print_report(job, plan, shape_gl_get_costs(renderer), &run, count, times, processor);
    free(times);
    free(processor);
    free(run.frames);
    free(run.rgba);
    free(run.last);
    return status;
}
