/* A moving view's picture by the processor, while the shaders are not compiled yet: what shaders/view/preview_one.frag,
 * preview.frag and preview_fill.frag draw, from the same grids, with the same starts, to rounding. On Mesa's llvmpipe the
 * shaders take longer to compile than all else that a first picture needs. Clouds alone: without opaque things and air. */
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "gl_private.h"
#include "shape/beam.h"
#include "shape/record.h"
#include "shape/random.h"

enum { TILE = 32, SKY_SPACING = 8, MOST = 12 }; /* as in the shaders; clouds that are marched along one ray */

static const float AGREEMENT = 0.2f, TRANSMITTANCE_END = 4e-3f, STEP_SCALE = 1.5f, STEP_DEPTH = 0.4f,
                   STEP_DEEP = 2;

/* One shown cloud's grids; t along a ray is in metres of the world. */
typedef struct dense_cloud {
    float row[3][4];             /* world to cloud; the eye in the cloud's frame */
    float low[3], high[3];       /* its box */
    float extinction, per_metre; /* at a baked density of 1; voxels a metre of the cloud's frame */
    const uint8_t *voxels;       /* NULL: not baked */
    int size[3];
    float baked_low[3];
    const float *light; /* 4 numbers a cell; NULL: not lit */
    int cells[3];
    float light_low[3], light_scale[3];
    const shape_medium *medium;
    shape_beam_peak peak;
} dense_cloud;

typedef struct painter {
    const gl_frame *frame;
    const dense_cloud *clouds;
    float forward[3], right[3], up[3];
    float growth;            /* of steps, metres a metre */
    float to_sun[3], sun[3]; /* its direction and irradiance */
    uint32_t seed;
    int width, height, across, down, sky_across, sky_down; /* the picture, its first pass, the sky */
    int stride; /* pixels from a ray of the first pass to the next */
    bool quick; /* of four pixels, and what lies between them is taken from these whether they agree or not */
    float *sky, *coarse; /* 3 and 4 numbers a texel: radiance; radiance without the sky, transmittance */
    float *rows;         /* scratch, row_floats a thread */
    float *rgba;         /* rows from below */
} painter;

/* One cloud along one ray. */
typedef struct crossing {
    const dense_cloud *cloud;
    float t0, t1, voxel;                 /* where its box is; metres of the world along the ray */
    float base[3], slope[3];             /* places among its voxels */
    float light_base[3], light_slope[3]; /* and cells */
    float near;                          /* the square of a metre of the ray, in cells */
    shape_beam beam;
    const float *sun; /* its irradiance */
} crossing;

typedef struct sight {
    float radiance[3], transmittance, start, growth;
    int steps, fetches;
} sight;

/* Unlike fminf and fmaxf these are an instruction each. */
static float least(float a, float b)
{
    return a < b ? a : b;
}

static float most(float a, float b)
{
    return a > b ? a : b;
}

static int least_int(int a, int b)
{
    return a < b ? a : b;
}

/* --- along a ray --- */

static void ray_at(const painter *p, int x, int y, float ray[3])
{
    const gl_frame *f = p->frame;
    float px = ((float)(x + f->part->x) + 0.5f) / (float)f->view->width * 2 - 1,
          py = ((float)(y + f->part->y) + 0.5f) / (float)f->view->height * 2 - 1, length = 0;
    for (int i = 0; i < 3; i++) {
        ray[i] = p->forward[i] + px * p->right[i] + py * p->up[i];
        length += ray[i] * ray[i];
    }
    length = 1 / sqrtf(length);
    for (int i = 0; i < 3; i++)
        ray[i] *= length;
}

static uint32_t hash_bits(uint32_t x)
{
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ (x >> 16);
}

static float start_at(const painter *p, int x, int y)
{
    uint32_t column = (uint32_t)(x + p->frame->part->x), row = (uint32_t)(y + p->frame->part->y);
    return (float)(hash_bits(column + hash_bits(row + p->seed)) >> 8) / 16777216.0f;
}

static bool cross(const dense_cloud *c, const float ray[3], crossing *to)
{
    float t0 = 0, t1 = 1e30f, length = 0;
    for (int i = 0; i < 3; i++) {
        float d = c->row[i][0] * ray[0] + c->row[i][1] * ray[1] + c->row[i][2] * ray[2], o = c->row[i][3];
        if (d == 0) {
            if (o < c->low[i] || o > c->high[i])
                return false;
        } else {
            float near = (c->low[i] - o) / d, far = (c->high[i] - o) / d;
            t0 = most(t0, least(near, far));
            t1 = least(t1, most(near, far));
        }
        length += d * d;
        to->base[i] = (o - c->baked_low[i]) * c->per_metre - 0.5f;
        to->slope[i] = d * c->per_metre;
        to->light_base[i] = (o - c->light_low[i]) * c->light_scale[i] - 0.5f;
        to->light_slope[i] = d * c->light_scale[i];
    }
    to->near = 0;
    for (int i = 0; i < 3; i++)
        to->near += to->light_slope[i] * to->light_slope[i];
    to->cloud = c;
    to->t0 = t0;
    to->t1 = t1;
    to->voxel = 1 / (c->per_metre * sqrtf(length));
    return t0 <= t1;
}

/* Where a filtered look-up lies: the lowest of eight texels, and how far from it. */
static size_t place_in(const int size[3], const float base[3], const float slope[3], float t, float part[3])
{
    int at[3];
    for (int i = 0; i < 3; i++) {
        float x = least(most(base[i] + t * slope[i], 0), (float)(size[i] - 1));
        at[i] = (int)x < size[i] - 2 ? (int)x : size[i] - 2;
        part[i] = x - (float)at[i];
    }
    return ((size_t)at[2] * (size_t)size[1] + (size_t)at[1]) * (size_t)size[0] + (size_t)at[0];
}

/* What the texture's filter gives, but 0 to 255, of density (0) or of the distance to the next matter (1). */
static float filter(const crossing *x, float t, int which)
{
    const int *n = x->cloud->size;
    float f[3], v[4];
    const uint8_t *first = x->cloud->voxels + 2 * place_in(n, x->base, x->slope, t, f) + which;
    const size_t row = 2 * (size_t)n[0], layer = row * (size_t)n[1];
    const uint8_t *rows[4] = {first, first + row, first + layer, first + layer + row};
    for (int i = 0; i < 4; i++)
        v[i] = (float)rows[i][0] + f[0] * (float)(rows[i][2] - rows[i][0]);
    float low = v[0] + f[1] * (v[1] - v[0]), high = v[2] + f[1] * (v[3] - v[2]);
    return low + f[2] * (high - low);
}

static float baked_at(const crossing *x, float t)
{
    return filter(x, t, 0) * (1 / 255.0f);
}

static void light_at(const crossing *x, float t, float light[3])
{
    const int *n = x->cloud->cells;
    float f[3];
    const size_t row = 4 * (size_t)n[0], layer = row * (size_t)n[1];
    const float *v = x->cloud->light + 4 * place_in(n, x->light_base, x->light_slope, t, f);
    const float *rows[4] = {v, v + row, v + layer, v + layer + row};
    float seen[4];
    for (int k = 0; k < 4; k++) {
        float l[4];
        for (int i = 0; i < 4; i++)
            l[i] = rows[i][k] + f[0] * (rows[i][4 + k] - rows[i][k]);
        float l0 = l[0] + f[1] * (l[1] - l[0]), l1 = l[2] + f[1] * (l[3] - l[2]);
        seen[k] = l0 + f[2] * (l1 - l0);
    }
    const float beam =
        shape_beam_source(&x->beam, x->cloud->medium->albedo, seen[3], shape_beam_straight(x->near * t * t));
    for (int k = 0; k < 3; k++)
        light[k] = seen[k] + beam * x->sun[k];
}

/* The share of the extinction at t that the ray is left with. */
static float kept_at(const crossing *x, float t)
{
    return shape_beam_kept(&x->beam, x->cloud->medium->albedo, x->near * t * t);
}

/* How far the empty blocks around t reach. */
static float leap(const crossing *x, float t)
{
    return (filter(x, t, 1) - 2) * 4 * x->voxel;
}

static void add_segment(sight *s, float extinction, const float source[3], float width)
{
    float passed = expf(-extinction * width), share = s->transmittance * (1 - passed);
    for (int k = 0; k < 3; k++)
        s->radiance[k] += share * source[k];
    s->transmittance *= passed;
}

static float step_length(const sight *s, const crossing *x, float t)
{
    float fine = most(STEP_SCALE * x->voxel, s->growth * t);
    float deep = least(STEP_DEPTH / most(x->cloud->extinction, 1e-6f), 6 * x->voxel);
    return most(fine, deep) * (1 + STEP_DEEP * (1 - s->transmittance));
}

/* One cloud alone: one look at the light serves two steps. */
static void march_alone(sight *s, const crossing *x, float t0, float t1)
{
    for (float t = t0; t < t1 && s->transmittance > TRANSMITTANCE_END;) {
        float width = least(step_length(s, x, t), 0.5f * (t1 - t) + 1e-6f), at = t + width * s->start;
        float first = baked_at(x, at), second = baked_at(x, at + width), source[3];
        s->steps += 2;
        s->fetches += 2;
        if (first + second > 0.002f) {
            const float kept = kept_at(x, t + width);
            light_at(x, t + width, source);
            for (int k = 0; k < 3; k++)
                source[k] /= kept;
            s->fetches++;
            add_segment(s, first * x->cloud->extinction * kept, source, width);
            add_segment(s, second * x->cloud->extinction * kept, source, width);
            t += 2 * width;
        } else {
            t += most(2 * width, leap(x, at));
        }
    }
}

/* Several clouds' boxes overlap: extinctions add. */
static void march_mixed(sight *s, const crossing *all, int count, float t0, float t1)
{
    for (float t = t0; t < t1 && s->transmittance > TRANSMITTANCE_END;) {
        float width = t1 - t, next = t1 - t, extinction = 0, source[3] = {0};
        for (int i = 0; i < count; i++)
            width = least(width, step_length(s, &all[i], t));
        float at = t + width * s->start;
        s->steps++;
        for (int i = 0; i < count; i++) {
            float light[3];
            if (at < all[i].t0 || at > all[i].t1)
                continue;
            float density = baked_at(&all[i], at);
            s->fetches++;
            if (density > 0.001f) {
                light_at(&all[i], at, light);
                s->fetches++;
                extinction += density * all[i].cloud->extinction * kept_at(&all[i], at);
                for (int k = 0; k < 3; k++)
                    source[k] += density * all[i].cloud->extinction * light[k];
                next = width;
            } else {
                next = least(next, most(width, leap(&all[i], at)));
            }
        }
        for (int k = 0; k < 3; k++)
            source[k] /= most(extinction, 1e-30f);
        if (extinction > 0)
            add_segment(s, extinction, source, width);
        for (int i = 0; i < count; i++)
            if (all[i].t0 > t)
                next = least(next, most(all[i].t0 - t, width));
        t += most(next, width);
    }
}

/* The clouds of the pixel's tile that the ray meets, nearest first; of a crowd the nearest. */
static int gather(const painter *p, int x, int y, const float ray[3], crossing *all)
{
    const gl_tiles *tiles = p->frame->tiles;
    const float *tile = tiles->texels + 4 * (size_t)(y / TILE * tiles->columns + x / TILE);
    const size_t first = (size_t)tile[0], end = first + (size_t)tile[1];
    int count = 0;
    for (size_t i = first; i < end; i++) {
        const dense_cloud *c = &p->clouds[(size_t)tiles->texels[4 * i]];
        crossing found;
        if (!c->voxels || !c->light || !cross(c, ray, &found))
            continue;
        found.beam = shape_beam_make(c->medium, &c->peak,
                                     ray[0] * p->to_sun[0] + ray[1] * p->to_sun[1] + ray[2] * p->to_sun[2]);
        found.sun = p->sun;
        if (count == MOST && all[MOST - 1].t0 <= found.t0)
            continue;
        int place = count < MOST ? count++ : MOST - 1;
        for (; place > 0 && all[place - 1].t0 > found.t0; place--)
            all[place] = all[place - 1];
        all[place] = found;
    }
    return count;
}

/* Radiance without the sky and transmittance of a pixel. */
static void look(const painter *p, int x, int y, float to[4], long *steps, long *fetches)
{
    crossing all[MOST];
    float ray[3];
    sight s = {.transmittance = 1, .start = p->quick ? 0.5f : start_at(p, x, y), .growth = p->growth};
    ray_at(p, x, y, ray);
    int count = gather(p, x, y, ray, all);
    for (int next = 0; next < count && s.transmittance > TRANSMITTANCE_END;) {
        int first = next++;
        float end = all[first].t1;
        for (; next < count && all[next].t0 < end; next++)
            end = most(end, all[next].t1);
        if (next == first + 1)
            march_alone(&s, &all[first], all[first].t0, end);
        else
            march_mixed(&s, all + first, next - first, all[first].t0, end);
    }
    bool closed = s.transmittance <= TRANSMITTANCE_END;
    for (int k = 0; k < 3; k++)
        to[k] = closed ? s.radiance[k] / (1 - s.transmittance) : s.radiance[k];
    to[3] = closed ? 0 : s.transmittance;
    *steps += s.steps;
    *fetches += s.fetches;
}

/* --- the picture --- */

/* What lies between two rows of texels, as long as these. */
static void mix_rows(const float *below, const float *above, float part, int count, float *to)
{
    for (int i = 0; i < count; i++)
        to[i] = below[i] + part * (above[i] - below[i]);
}

/* Whether the four rays of the first pass around a pixel agree about what lies between them. */
static bool agree(const painter *p, int x, int y, const float mean[4])
{
    const int s = p->stride, x0 = x / s, y0 = y / s, x1 = least_int(x0 + (x % s > 0), p->across - 1),
              y1 = least_int(y0 + (y % s > 0), p->down - 1);
    const float *a = p->coarse + 4 * (size_t)(y0 * p->across + x0),
                *b = p->coarse + 4 * (size_t)(y0 * p->across + x1),
                *c = p->coarse + 4 * (size_t)(y1 * p->across + x0),
                *d = p->coarse + 4 * (size_t)(y1 * p->across + x1);
    float apart[2];
    for (int k = 0; k < 2; k++) { /* green, transmittance */
        const int v = 1 + 2 * k;
        apart[k] = most(most(a[v], b[v]), most(c[v], d[v])) - least(least(a[v], b[v]), least(c[v], d[v]));
    }
    return most(apart[1], apart[0] / (mean[1] + mean[3] + 0.02f)) <= AGREEMENT;
}

/* Room for a row of the first pass, with one more, and one of the sky. */
static size_t row_floats(const painter *p)
{
    return 4 * ((size_t)p->across + 1) + 3 * (size_t)p->sky_across;
}

static void paint_row(const painter *p, int y, float *coarse, long *steps, long *fetches)
{
    float *sky = coarse + 4 * (p->across + 1);
    const int s = p->stride, y0 = y / s, y1 = least_int(y0 + (y % s > 0), p->down - 1);
    const float *sky_row = p->sky + 3 * (size_t)(y / SKY_SPACING) * (size_t)p->sky_across;
    mix_rows(p->coarse + 4 * (size_t)(y0 * p->across), p->coarse + 4 * (size_t)(y1 * p->across),
             (float)(y % s) / (float)s, 4 * p->across, coarse);
    mix_rows(sky_row, sky_row + 3 * p->sky_across, (float)(y % SKY_SPACING) / SKY_SPACING, 3 * p->sky_across,
             sky);
    memcpy(coarse + 4 * p->across, coarse + 4 * (p->across - 1), 4 * sizeof *coarse); /* beyond the last */
    for (int x = 0; x < p->width; x++) {
        const float *near = coarse + 4 * (x / s), *behind = sky + 3 * (x / SKY_SPACING);
        const float part = (float)(x % s) / (float)s, sky_part = (float)(x % SKY_SPACING) / SKY_SPACING;
        float *to = p->rgba + 4 * ((size_t)y * (size_t)p->width + (size_t)x), seen[4];
        for (int k = 0; k < 4; k++)
            seen[k] = near[k] + part * (near[4 + k] - near[k]);
        if (!p->quick && !agree(p, x, y, seen))
            look(p, x, y, seen, steps, fetches);
        for (int k = 0; k < 3; k++)
            to[k] = seen[k] + seen[3] * (behind[k] + sky_part * (behind[3 + k] - behind[k]));
        to[3] = 1 - seen[3];
    }
}

static bool has_cloud(const painter *p, int x, int y)
{
    const gl_tiles *tiles = p->frame->tiles;
    return tiles->texels[4 * (size_t)(y / TILE * tiles->columns + x / TILE) + 1] > 0;
}

static void paint(const painter *p, const shape_sky *sky, double *steps, double *fetches)
{
    long step_sum = 0, fetch_sum = 0;
#pragma omp parallel reduction(+ : step_sum, fetch_sum)
    {
#pragma omp for schedule(dynamic, 4) nowait
        for (int y = 0; y < p->sky_down; y++)
            for (int x = 0; x < p->sky_across; x++) {
                float ray[3];
                ray_at(p, x * SKY_SPACING, y * SKY_SPACING, ray);
                shape_sky_radiance(sky, shape_vec3_make(ray[0], ray[1], ray[2]),
                                   p->sky + 3 * ((size_t)y * (size_t)p->sky_across + (size_t)x));
            }
#pragma omp for schedule(dynamic, 4)
        for (int y = 0; y < p->down; y++)
            for (int x = 0; x < p->across; x++) {
                float *to = p->coarse + 4 * ((size_t)y * (size_t)p->across + (size_t)x);
                to[0] = to[1] = to[2] = 0;
                to[3] = 1;
                if (has_cloud(p, p->stride * x, p->stride * y))
                    look(p, p->stride * x, p->stride * y, to, &step_sum, &fetch_sum);
            }
#pragma omp for schedule(dynamic, 4)
        for (int y = 0; y < p->height; y++)
            paint_row(p, y, p->rows + (size_t)omp_get_thread_num() * row_floats(p), &step_sum, &fetch_sum);
    }
    *steps = (double)step_sum;
    *fetches = (double)fetch_sum;
}

/* --- what it is painted from --- */

static void take_cloud(const shape_gl_renderer *r, const gl_grids *grids, int cloud, const float *cells,
                       dense_cloud *to)
{
    const float(*record)[4] = (const float(*)[4])(r->scene.records + (size_t)cloud * SHAPE_RECORD_TEXELS * 4);
    const gl_dense *dense = grids->baked->dense[cloud];
    const gl_lit *lit = grids->light->lit[cloud];
    memset(to, 0, sizeof *to);
    to->extinction = record[3][3];
    to->medium = &r->volume->clouds[cloud].medium;
    to->peak = (shape_beam_peak){.cap = record[35][3], .ahead = record[34][3]};
    for (int i = 0; i < 3; i++) {
        to->low[i] = record[3][i];
        to->high[i] = record[4][i];
    }
    if (dense) {
        to->voxels = dense->baked.voxels;
        to->per_metre = 1 / dense->baked.voxel;
        memcpy(to->size, dense->baked.size, sizeof to->size);
        memcpy(to->baked_low, &dense->baked.box.min, sizeof to->baked_low);
    }
    for (int i = 0; lit && i < 3; i++) {
        const float low = (&lit->grid.box.min.x)[i], high = (&lit->grid.box.max.x)[i];
        to->cells[i] = lit->grid.size[i];
        to->light_low[i] = low;
        to->light_scale[i] = (float)lit->grid.size[i] / (high - low);
        to->light = lit->grid.size[i] > 1 && (i == 0 || to->light) ? cells : NULL;
    }
}

/* The shown clouds, in the tiles' order; the light's cells are as gl_light_compose has just left them. */
static void take_clouds(const shape_gl_renderer *r, const gl_grids *grids, shape_dvec3 eye,
                        dense_cloud *clouds)
{
    const float *cells = grids->light->cells;
    for (int i = 0; i < r->scene.shown_count; i++) {
        int cloud = r->scene.shown[i];
        const gl_lit *lit = grids->light->lit[cloud];
        shape_record record;
        take_cloud(r, grids, cloud, cells, &clouds[i]);
        shape_record_set_eye(record, &r->volume->clouds[cloud], eye);
        memcpy(clouds[i].row, record, sizeof clouds[i].row);
        if (lit)
            cells += 4 * (size_t)lit->grid.size[0] * (size_t)lit->grid.size[1] * (size_t)lit->grid.size[2];
    }
}

static void aim(painter *p, const shape_gl_renderer *r, const gl_frame *frame)
{
    const shape_camera *c = frame->camera;
    p->frame = frame;
    for (int i = 0; i < 3; i++) {
        p->forward[i] = (float)(&c->forward.x)[i];
        p->right[i] = (float)(&c->right.x)[i];
        p->up[i] = (float)(&c->up.x)[i];
        p->to_sun[i] = (float)(&r->light.sun.x)[i];
        p->sun[i] = r->light.sun_irradiance[i];
    }
    p->growth = 2 * (float)(2 * tan(frame->view->fov * 3.14159265358979 / 360) / frame->view->height);
    p->seed = (uint32_t)(shape_hash(r->options.seed) ^ shape_hash(1));
    p->width = r->width;
    p->height = r->height;
    p->quick = frame->quick;
    p->stride = p->quick ? 4 : 2;
    p->across = (p->width + p->stride - 1) / p->stride;
    p->down = (p->height + p->stride - 1) / p->stride;
    p->sky_across = p->width / SKY_SPACING + 2;
    p->sky_down = p->height / SKY_SPACING + 2;
}

/* Into the picture's texture, and the mean of the work into its other one. */
static void send(const shape_gl_renderer *r, const painter *p, double steps, double fetches)
{
    const double pixels = (double)p->width * (double)p->height;
    const float work[] = {(float)(steps / pixels), (float)(fetches / pixels), 0, 0};
    glBindFramebuffer(GL_FRAMEBUFFER, r->mean.framebuffer);
    glClearBufferfv(GL_COLOR, 1, work);
    glBindTexture(GL_TEXTURE_2D, r->mean.textures[0]);
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, p->width, p->height, GL_RGBA, GL_FLOAT, p->rgba);
}

shape_status gl_early_draw(shape_gl_renderer *r, const gl_grids *grids, const gl_frame *frame,
                           shape_error *error)
{
    painter p = {0};
    double steps, fetches;
    aim(&p, r, frame);
    dense_cloud *clouds = malloc(((size_t)r->scene.shown_count + 1) * sizeof *clouds);
    p.sky = malloc(sizeof *p.sky * 3 * (size_t)p.sky_across * (size_t)p.sky_down);
    p.coarse = malloc(sizeof *p.coarse * 4 * (size_t)p.across * (size_t)p.down);
    p.rgba = malloc(sizeof *p.rgba * 4 * (size_t)p.width * (size_t)p.height);
    p.rows = malloc(sizeof *p.rows * row_floats(&p) * (size_t)omp_get_max_threads());
    shape_status status =
        clouds && p.sky && p.coarse && p.rows && p.rgba ? SHAPE_OK : shape_error_memory(error);
    if (!status) {
        shape_sky sky = r->sky;
        if (r->options.no_background)
            sky.kind = SHAPE_SKY_NONE;
        take_clouds(r, grids, frame->camera->origin, clouds);
        p.clouds = clouds;
        paint(&p, &sky, &steps, &fetches);
        send(r, &p, steps, fetches);
        r->preview.moving = false; /* all its work is in the picture */
    }
    free(clouds);
    free(p.sky);
    free(p.coarse);
    free(p.rows);
    free(p.rgba);
    return status;
}
