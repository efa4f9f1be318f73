/* Which bricks of a lattice hold something: primitives are sorted into coarse cells, and each cell is halved down to
 * bricks, keeping at each level the primitives that touch it; what lies wholly inside one is a tile at once. */
#include "shape/voxels.h"

#include <math.h>
#include <omp.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "field/voxels_private.h"

enum { COARSE_LEAST = 16, COARSE_MOST = 4096 }; /* voxels along a coarse cell; cells in all */

shape_voxel_request shape_voxel_request_defaults(void)
{
    shape_voxel_request r = {.cloud = -1, .scale = 1, .band = 3};
    return r;
}

/* One walk over a lattice. */
typedef struct walk {
    voxel_job job;
    const shape_voxel_sink *sink; /* NULL: count */
    float grow;                   /* how far beyond a support there is something [voxels] */
    float solid;                  /* so deep inside all is one value [voxels]; infinite: nowhere */
    size_t most;
    atomic_size_t bricks;
    atomic_bool stop, no_memory;
} walk;

/* A primitive as one coarse cell sees it: its centre from the cell's first voxel, how near to it a voxel must be to be
 * touched, and how near to be held with `solid` voxels to spare. Where it is no ball, touch is below 0. */
typedef struct near {
    float c[3], touch, hold;
    int32_t form;
} near;

/* One thread's lists of primitives, one behind the other, and its brick. */
typedef struct worker {
    near *lists;
    int32_t *names; /* the forms of one brick */
    size_t capacity, name_capacity;
    int32_t origin[3]; /* of the coarse cell */
    voxel_room *room;
} worker;

/* Whether another form's box touches a cell. */
static bool is_touched(const walk *w, const voxel_form *f, const int32_t first[3], int32_t edge)
{
    float reach = w->grow + f->slack;
    for (int k = 0; k < 3; k++) {
        float below = (float)(first[k] - f->c[k]), above = (float)(f->c[k] - (first[k] + (edge - 1)));
        if ((below > above ? below : above) > f->h[k] + reach)
            return false;
    }
    return true;
}

/* Whether it holds all of a cell, with `solid` voxels to spare. */
static bool holds(const walk *w, const voxel_form *f, const int32_t first[3], int32_t edge)
{
    float spare = w->solid + f->slack, a[3], b[3];
    float limit = 1 - spare / f->thin;
    if (!(limit > 0))
        return false;
    for (int k = 0; k < 3; k++) {
        a[k] = (float)(first[k] - f->c[k]);
        b[k] = a[k] + (float)(edge - 1);
    }
    for (int corner = 0; corner < 8; corner++) {
        const float v[3] = {corner & 1 ? a[0] : b[0], corner & 2 ? a[1] : b[1], corner & 4 ? a[2] : b[2]};
        float u2 = 0;
        for (int i = 0; i < 3; i++) {
            float x = f->m[i][0] * v[0] + f->m[i][1] * v[1] + f->m[i][2] * v[2];
            u2 += x * x;
        }
        if (u2 > limit * limit)
            return false;
    }
    return true;
}

/* Whether being inside this cloud's primitives is all that a voxel's value depends on. */
static bool can_be_solid(const walk *w, uint32_t index)
{
    const shape_volume_cloud *cloud = &w->job.volume->clouds[index];
    if (!isfinite(w->solid) || cloud->field.model == SHAPE_MODEL_METABALL)
        return false;
    return w->job.request->quantity == SHAPE_VOXEL_SDF ||
           (cloud->field.model == SHAPE_MODEL_UNIFORM && !cloud->detailed);
}

/* The primitives of lists[begin .. end) that touch a cell, kept behind `end` (or, from a coarse cell's own, in place);
 * returns where they end. *solid: one of them holds all of the cell, and nothing else adds to it. */
static size_t keep_touching(const walk *w, worker *t, const int32_t first[3], int32_t edge, size_t begin,
                            size_t end, size_t to, bool *solid)
{
    float low[3], half = 0.5f * (float)(edge - 1);
    size_t last = to;
    bool held = false;
    for (int k = 0; k < 3; k++)
        low[k] = (float)(first[k] - t->origin[k]) + half;
    for (size_t i = begin; i < end; i++) {
        const near *n = &t->lists[i];
        if (n->touch < 0) {
            const voxel_form *f = &w->job.forms[n->form];
            if (!is_touched(w, f, first, edge))
                continue;
            held = held || (n->hold > 0 && holds(w, f, first, edge));
        } else {
            float nearest = 0, farthest = 0;
            for (int k = 0; k < 3; k++) {
                float d = fabsf(n->c[k] - low[k]), out = d - half;
                out = out > 0 ? out : 0;
                nearest += out * out;
                farthest += (d + half) * (d + half);
            }
            if (nearest > n->touch * n->touch)
                continue;
            held = held || (n->hold > 0 && farthest <= n->hold * n->hold);
        }
        t->lists[last++] = *n;
    }
    const voxel_form *forms = w->job.forms;
    *solid = held && (w->job.request->quantity == SHAPE_VOXEL_SDF ||
                      forms[t->lists[to].form].cloud == forms[t->lists[last - 1].form].cloud);
    return last;
}

static void give_up(walk *w)
{
    atomic_store(&w->no_memory, true);
    atomic_store(&w->stop, true);
}

static void put_tile(walk *w, const int32_t first[3], int32_t edge, float value)
{
    if (w->sink && !w->sink->tile(w->sink->context, first, edge, value))
        give_up(w);
}

static void put_solid(walk *w, const int32_t first[3], int32_t edge, int32_t form)
{
    const shape_voxel_request *r = w->job.request;
    float value = r->quantity == SHAPE_VOXEL_SDF ? (float)(-r->band * w->job.lattice->edge)
                                                 : w->job.weights[w->job.forms[form].cloud];
    if (value != 0)
        put_tile(w, first, edge, value);
}

/* Whether all of a channel's values are one. */
static bool is_one_value(const float *values)
{
    int same = 1;
    for (int i = 0; i < VOXEL_BRICK; i++)
        same &= values[i] == values[0];
    return same;
}

static void put_filled(walk *w, const int32_t first[3], voxel_room *room)
{
    const shape_voxel_request *r = w->job.request;
    const float *v = room->values;
    bool one = is_one_value(v);
    if (r->quantity == SHAPE_VOXEL_SAMPLE) { /* no tiles of three channels */
        if (one && v[0] == 0 && is_one_value(v + VOXEL_BRICK) && v[VOXEL_BRICK] == 0 &&
            is_one_value(v + 2 * VOXEL_BRICK) && v[2 * VOXEL_BRICK] == 0)
            return;
        one = false;
    }
    if (one && (v[0] == 0 || (r->quantity == SHAPE_VOXEL_SDF && v[0] > 0)))
        return;
    if (one)
        put_tile(w, first, VOXEL_EDGE, v[0]);
    else if (!w->sink->brick(w->sink->context, first, v))
        give_up(w);
}

static void put_brick(walk *w, worker *t, const int32_t first[3], size_t begin, size_t end)
{
    if (!w->sink) {
        if (atomic_fetch_add(&w->bricks, 1) >= w->most)
            atomic_store(&w->stop, true);
        return;
    }
    if (shape_array_reserve((void **)&t->names, &t->name_capacity, end - begin, sizeof *t->names, NULL)) {
        give_up(w);
        return;
    }
    for (size_t i = begin; i < end; i++)
        t->names[i - begin] = t->lists[i].form;
    voxel_brick_fill(&w->job, first, t->names, end - begin, t->room);
    put_filled(w, first, t->room);
}

static void descend(walk *w, worker *t, const int32_t first[3], int32_t edge, size_t begin, size_t end)
{
    if (atomic_load_explicit(&w->stop, memory_order_relaxed))
        return;
    if (edge == VOXEL_EDGE) {
        put_brick(w, t, first, begin, end);
        return;
    }
    if (shape_array_reserve((void **)&t->lists, &t->capacity, 2 * end - begin, sizeof *t->lists, NULL)) {
        give_up(w);
        return;
    }
    for (int child = 0; child < 8; child++) {
        int32_t half = edge / 2, from[3];
        for (int k = 0; k < 3; k++)
            from[k] = first[k] + (child >> k & 1 ? half : 0);
        bool solid;
        size_t last = keep_touching(w, t, from, half, begin, end, end, &solid);
        if (last == end)
            continue;
        if (solid)
            put_solid(w, from, half, t->lists[end].form);
        else
            descend(w, t, from, half, end, last);
    }
}

/* The coarse cells, and which primitives' boxes touch each: those of cell i are list[start[i] .. start[i + 1]). */
typedef struct cells {
    int32_t edge, low[3], size[3];
    size_t count, *start;
    int32_t *list;
} cells;

static void span(const cells *c, const voxel_form *f, float grow, int32_t from[3], int32_t to[3])
{
    for (int k = 0; k < 3; k++) {
        double reach = (double)(f->h[k] + grow + f->slack);
        double a = floor((f->c[k] - reach) / c->edge) - c->low[k],
               b = floor((f->c[k] + reach) / c->edge) - c->low[k];
        from[k] = a > 0 ? (int32_t)a : 0;
        to[k] = b < c->size[k] - 1 ? (int32_t)b : c->size[k] - 1;
    }
}

static void choose_cells(cells *c, const voxel_forms *forms, float grow, const shape_voxel_lattice *lattice)
{
    double min[3] = {INFINITY, INFINITY, INFINITY}, max[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < forms->count; i++)
        for (int k = 0; k < 3; k++) {
            const voxel_form *f = &forms->items[i];
            double reach = (double)(f->h[k] + grow + f->slack);
            min[k] = fmin(min[k], f->c[k] - reach);
            max[k] = fmax(max[k], f->c[k] + reach);
        }
    /* No density outside a layer's bounds, which its supports go beyond. */
    for (int k = 0; k < 3; k++) {
        double beyond = (double)grow + 2 * (double)(forms->count ? forms->items[0].slack : 0);
        min[k] = fmax(min[k], -1 - beyond);
        max[k] = fmin(max[k], lattice->size[k] + beyond);
    }
    double wanted;
    c->edge = COARSE_LEAST / 2;
    do {
        c->edge *= 2;
        wanted = 1;
        for (int k = 0; k < 3; k++) {
            c->low[k] = (int32_t)floor(min[k] / c->edge);
            c->size[k] = (int32_t)floor(max[k] / c->edge) - c->low[k] + 1;
            wanted *= c->size[k];
        }
    } while (wanted > COARSE_MOST && c->edge < 1 << 28);
    c->count = (size_t)wanted;
}

/* A counting sort; the primitives of a cell stay in order. */
static shape_status sort_into_cells(cells *c, const voxel_forms *forms, float grow, shape_error *error)
{
    c->start = calloc(c->count + 2, sizeof *c->start);
    if (!c->start)
        return shape_error_memory(error);
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < forms->count; i++) {
            int32_t from[3], to[3];
            span(c, &forms->items[i], grow, from, to);
            for (int32_t z = from[2]; z <= to[2]; z++)
                for (int32_t y = from[1]; y <= to[1]; y++)
                    for (int32_t x = from[0]; x <= to[0]; x++) {
                        size_t cell =
                            ((size_t)z * (size_t)c->size[1] + (size_t)y) * (size_t)c->size[0] + (size_t)x;
                        if (pass == 0)
                            c->start[cell + 2]++;
                        else
                            c->list[c->start[cell + 1]++] = (int32_t)i;
                    }
        }
        if (pass)
            break;
        for (size_t i = 2; i < c->count + 2; i++)
            c->start[i] += c->start[i - 1];
        c->list = malloc((c->start[c->count + 1] + 1) * sizeof *c->list);
        if (!c->list)
            return shape_error_memory(error);
    }
    return SHAPE_OK;
}

static near look_at(const walk *w, int32_t form, const int32_t origin[3])
{
    const voxel_form *f = &w->job.forms[form];
    near n = {.form = form, .touch = -1, .hold = can_be_solid(w, f->cloud) ? 1 : 0};
    for (int k = 0; k < 3; k++)
        n.c[k] = (float)(f->c[k] - origin[k]);
    if (f->radius > 0) {
        float hold = f->radius - f->slack - w->solid;
        n.touch = f->radius + f->slack + w->grow;
        n.hold = n.hold > 0 && hold > 0 ? hold : 0;
    }
    return n;
}

static void walk_cell(walk *w, worker *t, const cells *c, size_t cell)
{
    int32_t first[3] = {(int32_t)(cell % (size_t)c->size[0]),
                        (int32_t)(cell / (size_t)c->size[0] % (size_t)c->size[1]),
                        (int32_t)(cell / (size_t)c->size[0] / (size_t)c->size[1])};
    for (int k = 0; k < 3; k++)
        first[k] = (first[k] + c->low[k]) * c->edge;
    size_t begin = c->start[cell], count = c->start[cell + 1] - begin;
    if (shape_array_reserve((void **)&t->lists, &t->capacity, count, sizeof *t->lists, NULL)) {
        give_up(w);
        return;
    }
    memcpy(t->origin, first, sizeof t->origin);
    for (size_t i = 0; i < count; i++)
        t->lists[i] = look_at(w, c->list[begin + i], first);
    bool solid;
    count = keep_touching(w, t, first, c->edge, 0, count, 0, &solid);
    if (!count)
        return;
    if (solid)
        put_solid(w, first, c->edge, t->lists[0].form);
    else
        descend(w, t, first, c->edge, 0, count);
}

static void walk_cells(walk *w, const cells *c)
{
    int threads = w->job.request->threads > 0 ? w->job.request->threads : omp_get_max_threads();
#pragma omp parallel num_threads(threads)
    {
        worker t = {.room = malloc(sizeof(voxel_room))};
        if (!t.room)
            give_up(w);
#pragma omp for schedule(dynamic, 1)
        for (size_t cell = 0; cell < c->count; cell++)
            if (c->start[cell + 1] > c->start[cell] && !atomic_load(&w->stop))
                walk_cell(w, &t, c, cell);
        free(t.lists);
        free(t.names);
        free(t.room);
    }
}

static shape_status check(const shape_volume *volume, const shape_voxel_request *r, shape_error *error)
{
    if (!(r->ramp >= 0 && r->ramp <= 1e6))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "a ramp of %g voxels (0 to 1e6)", r->ramp);
    if (!(r->band > 0 && r->band <= 1e6))
        return shape_error_set(error, SHAPE_ERROR_ARGUMENT, "a band of %g voxels (above 0, to 1e6)", r->band);
    for (size_t i = 0; i < volume->cloud_count && r->ramp > 0; i++)
        if ((r->cloud < 0 || i == (size_t)r->cloud) &&
            (volume->clouds[i].field.model != SHAPE_MODEL_UNIFORM || volume->clouds[i].detailed))
            return shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                                   "a ramp is for uniform clouds without details (leave it out)");
    return SHAPE_OK;
}

/* A cloud's share of density: its extinction over the greatest of those asked for. */
static shape_status weigh(walk *w, const shape_volume *volume, shape_error *error)
{
    float most = 0;
    const shape_voxel_request *r = w->job.request;
    const float scale = r->quantity == SHAPE_VOXEL_DENSITY ? (float)r->scale : 1;
    int one = r->cloud;
    w->job.weights = malloc((volume->cloud_count + 1) * sizeof *w->job.weights);
    if (!w->job.weights)
        return shape_error_memory(error);
    for (size_t i = 0; i < volume->cloud_count; i++)
        if ((one < 0 || i == (size_t)one) && volume->clouds[i].medium.extinction > most)
            most = volume->clouds[i].medium.extinction;
    for (size_t i = 0; i < volume->cloud_count; i++)
        w->job.weights[i] = scale * (most > 0 ? volume->clouds[i].medium.extinction / most : 1);
    return SHAPE_OK;
}

static shape_status run(walk *w, shape_error *error)
{
    const shape_voxel_request *r = w->job.request;
    voxel_forms forms = {0};
    cells c = {0};
    bool sdf = r->quantity == SHAPE_VOXEL_SDF;
    w->grow = sdf ? (float)r->band : 0;
    w->solid = sdf ? (float)r->band : r->quantity == SHAPE_VOXEL_DENSITY ? (float)r->ramp : INFINITY;
    shape_status status = check(w->job.volume, r, error);
    if (!status)
        status = voxel_forms_make(w->job.volume, r->cloud, w->job.lattice, &forms, error);
    if (!status)
        status = weigh(w, w->job.volume, error);
    if (!status && forms.count) {
        w->job.forms = forms.items;
        choose_cells(&c, &forms, w->grow, w->job.lattice);
        status = sort_into_cells(&c, &forms, w->grow, error);
        if (!status)
            walk_cells(w, &c);
        if (!status && atomic_load(&w->no_memory))
            status = shape_error_memory(error);
    }
    free(c.start);
    free(c.list);
    free(w->job.weights);
    free(forms.items);
    return status;
}

shape_status shape_voxels_fill(const shape_volume *volume, const shape_voxel_lattice *lattice,
                               const shape_voxel_request *request, const shape_voxel_sink *sink,
                               shape_error *error)
{
    walk w = {.job = {volume, lattice, request, NULL, NULL}, .sink = sink};
    return run(&w, error);
}

shape_status shape_voxels_count(const shape_volume *volume, const shape_voxel_lattice *lattice,
                                const shape_voxel_request *request, size_t most, size_t *bricks,
                                shape_error *error)
{
    walk w = {.job = {volume, lattice, request, NULL, NULL}, .most = most};
    shape_status status = run(&w, error);
    *bricks = atomic_load(&w.bricks);
    return status;
}
