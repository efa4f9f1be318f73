/* Which primitives of a single cloud the tiles of the picture may see, nearest first: the exact view reads these
 * (shaders/view/march_list.glsl) rather than walk the tree in every pixel. Each support is taken as the ball around it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gl_private.h"

enum { TILE = 8, MOST_IN_TILE = 2000, MOST_TEXELS = 8000000 };

typedef struct ball {
    float item[4]; /* centre relative to the eye [m, cloud's frame], radius; of an ellipsoid negative */
    float nearest; /* no ray of the world meets it before this [m] */
    int ellipsoid;
    int x0, y0, x1, y1; /* tiles, inclusive */
} ball;

/* What is looked at, and from where. */
typedef struct looking {
    const shape_volume_cloud *cloud;
    const shape_view *view;
    const shape_gl_part *part;
    const shape_camera *camera;
    shape_dvec3 eye;       /* in the cloud's frame */
    double stretch, scale; /* most, least metres of the world a metre of the cloud's frame */
    int columns, rows;
} looking;

/* Where things stand in the lists' texture. */
typedef struct list_layout {
    size_t tiles, items,
        ellipsoids; /* texels of each: the tiles come first, then the items, then the ellipsoids */
} list_layout;

/* How much longer a vector can become. */
static double stretch(const shape_frame *f)
{
    double sum = 0;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            sum += f->m[row][column] * f->m[row][column];
    double even = 0, first = 0;
    for (int row = 0; row < 3; row++)
        first += f->m[row][0] * f->m[row][0];
    /* Frames that turn and scale alike along all axes have columns of one length, at right angles. */
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            double product = 0;
            for (int row = 0; row < 3; row++)
                product += f->m[row][a] * f->m[row][b];
            even += fabs(product - (a == b ? first : 0));
        }
    return even < 1e-6 * first ? sqrt(first) * (1 + 1e-6) : sqrt(sum);
}

/* The tiles along one side of the picture that a ball covers: tangents through the eye in the plane of that side's axis and
 * the view's axis. half: half the picture in units of the depth; the tiles are those of a part, which
 * begins at pixel `begin` of all `pixels`. */
static void cover_side(double side, double depth, double radius, double half, int pixels, int begin,
                       int tiles, int *low, int *high)
{
    double distance2 = side * side + depth * depth;
    *low = 0, *high = tiles - 1;
    if (distance2 <= radius * radius * 1.0001)
        return;
    double reach = asin(radius / sqrt(distance2)), middle = atan2(side, depth), quarter = 1.5707;
    double edges[2] = {middle - reach, middle + reach};
    if (edges[0] <= -quarter || edges[1] >= quarter) {
        if (middle - reach >= quarter || middle + reach <= -quarter)
            *high = -1; /* behind the eye's plane */
        return;
    }
    double from = (tan(edges[0]) / half + 1) / 2 * pixels - begin,
           to = (tan(edges[1]) / half + 1) / 2 * pixels - begin;
    *low = (int)fmin(fmax(floor((from - 1) / TILE), 0), tiles);
    *high = (int)fmax(fmin(floor((to + 1) / TILE), tiles - 1), -1);
}

static ball see(const looking *at, shape_vec3 centre, double radius, int ellipsoid)
{
    shape_dvec3 c = {(double)centre.x, (double)centre.y, (double)centre.z};
    shape_dvec3 from_eye = shape_dvec3_sub(c, at->eye);
    ball b = {.ellipsoid = ellipsoid};
    b.item[0] = (float)from_eye.x, b.item[1] = (float)from_eye.y, b.item[2] = (float)from_eye.z;
    b.item[3] = (float)(ellipsoid >= 0 ? -radius * (1 + 1e-4) : radius);
    b.nearest = (float)((shape_dvec3_length(from_eye) - radius) * at->scale);

    shape_dvec3 p = shape_dvec3_sub(shape_frame_point(&at->cloud->frame, c), at->camera->origin);
    double width = shape_dvec3_length(at->camera->right), height = shape_dvec3_length(at->camera->up);
    double depth = shape_dvec3_dot(p, at->camera->forward);
    /* The shader has single precision. */
    radius = radius * at->stretch * (1 + 1e-4) + 1e-5 * shape_dvec3_length(p);
    cover_side(shape_dvec3_dot(p, at->camera->right) / width, depth, radius, width, at->view->width,
               at->part->x, at->columns, &b.x0, &b.x1);
    cover_side(shape_dvec3_dot(p, at->camera->up) / height, depth, radius, height, at->view->height,
               at->part->y, at->rows, &b.y0, &b.y1);
    return b;
}

static int compare(const void *a, const void *b)
{
    const ball *x = a, *y = b;
    if (x->nearest != y->nearest)
        return x->nearest < y->nearest ? -1 : 1;
    if (x->ellipsoid != y->ellipsoid)
        return x->ellipsoid < y->ellipsoid ? -1 : 1;
    return memcmp(x->item, y->item, sizeof x->item);
}

static void see_all(const looking *at, ball *balls)
{
    const shape_primitives *list = at->cloud->list;
    double support = (double)at->cloud->support;
    for (size_t i = 0; i < list->sphere_count; i++) {
        const shape_sphere *s = &list->spheres[i];
        *balls++ = see(at, shape_vec3_make(s->x, s->y, s->z), support * (double)s->radius, -1);
    }
    for (size_t i = 0; i < list->ellipsoid_count; i++) {
        const shape_ellipsoid *e = &list->ellipsoids[i];
        double radius = fmax((double)e->a, fmax((double)e->b, (double)e->c));
        *balls++ = see(at, shape_vec3_make(e->x, e->y, e->z), support * radius, (int)i);
    }
}

/* An ellipsoid as three rows: from the cloud's frame to the one in which it is the unit ball; w: the eye there. */
static void write_ellipsoid(const shape_ellipsoid *e, shape_dvec3 eye, float *rows)
{
    double turn[3][3], axes[3] = {(double)e->a, (double)e->b, (double)e->c};
    double v[3] = {eye.x - (double)e->x, eye.y - (double)e->y, eye.z - (double)e->z};
    shape_quat_matrix(e->q, turn);
    for (int row = 0; row < 3; row++, rows += 4) {
        double w = 0;
        for (int k = 0; k < 3; k++) {
            rows[k] = (float)(turn[k][row] / axes[row]);
            w += turn[k][row] / axes[row] * v[k];
        }
        rows[3] = (float)w;
    }
}

/* Counts the texels of each tile's list into counts. False where lists are too long. */
static bool count_items(const looking *at, const ball *balls, size_t count, size_t *counts,
                        list_layout *layout)
{
    size_t longest = 0;
    layout->items = 0;
    for (size_t i = 0; i < count && layout->items <= MOST_TEXELS; i++)
        for (int y = balls[i].y0; y <= balls[i].y1; y++)
            for (int x = balls[i].x0; x <= balls[i].x1; x++) {
                size_t texels = balls[i].ellipsoid >= 0 ? 2 : 1, *length = &counts[y * at->columns + x];
                *length += texels;
                layout->items += texels;
                longest = *length > longest ? *length : longest;
            }
    return longest <= MOST_IN_TILE && layout->items <= MOST_TEXELS;
}

/* Offsets and lengths of the tiles' lists, the lists in the balls' order, and the ellipsoids. */
static void write_lists(const looking *at, const ball *balls, size_t count, size_t *next,
                        const list_layout *layout, float *lists)
{
    size_t offset = layout->tiles, shapes = layout->tiles + layout->items;
    for (size_t i = 0; i < layout->tiles; i++) {
        lists[4 * i] = (float)offset;
        lists[4 * i + 1] = (float)next[i];
        size_t length = next[i];
        next[i] = offset;
        offset += length;
    }
    for (size_t i = 0; i < count; i++)
        for (int y = balls[i].y0; y <= balls[i].y1; y++)
            for (int x = balls[i].x0; x <= balls[i].x1; x++) {
                float *entry = lists + 4 * next[y * at->columns + x]++;
                memcpy(entry, balls[i].item, sizeof balls[i].item);
                if (balls[i].ellipsoid < 0)
                    continue;
                next[y * at->columns + x]++;
                entry[4] = (float)(shapes + 3 * (size_t)balls[i].ellipsoid);
            }
    for (size_t i = 0; i < at->cloud->list->ellipsoid_count; i++)
        write_ellipsoid(&at->cloud->list->ellipsoids[i], at->eye, lists + 4 * (shapes + 3 * i));
}

static shape_status make_lists(gl_tiles *tiles, const looking *at, ball *balls, size_t count, size_t *next,
                               shape_error *error)
{
    list_layout layout = {(size_t)at->columns * (size_t)at->rows, 0, 3 * at->cloud->list->ellipsoid_count};
    see_all(at, balls);
    qsort(balls, count, sizeof *balls, compare);
    if (!count_items(at, balls, count, next, &layout))
        return SHAPE_OK;
    size_t texels = layout.tiles + layout.items + layout.ellipsoids;
    float *lists = calloc(texels * 4 + 4, sizeof *lists);
    if (!lists)
        return shape_error_memory(error);
    shape_status status = SHAPE_OK;
    write_lists(at, balls, count, next, &layout, lists);
    tiles->primitives = gl_float_texture(lists, texels, &status, error);
    tiles->listed = !status;
    tiles->list_columns = at->columns;
    tiles->list_scale = (float)at->scale;
    free(lists);
    return status;
}

bool gl_tiles_can_list(const shape_volume *volume)
{
    return volume->cloud_count == 1 && volume->clouds[0].field.model != SHAPE_MODEL_GRID;
}

shape_status gl_tiles_list_primitives(gl_tiles *tiles, const shape_volume *volume, const shape_view *view,
                                      const shape_gl_part *part, const shape_camera *camera,
                                      shape_error *error)
{
    if (!gl_tiles_can_list(volume))
        return SHAPE_OK;
    const shape_volume_cloud *c = &volume->clouds[0];
    looking at = {.cloud = c, .view = view, .part = part, .camera = camera};
    at.eye = shape_frame_point(&c->inverse, camera->origin);
    at.stretch = stretch(&c->frame);
    at.scale = 1 / stretch(&c->inverse);
    at.columns = (part->width + TILE - 1) / TILE;
    at.rows = (part->height + TILE - 1) / TILE;
    size_t count = shape_primitives_count(c->list);
    ball *balls = calloc(count + 1, sizeof *balls);
    size_t *next = calloc((size_t)at.columns * (size_t)at.rows + 1, sizeof *next);
    shape_status status =
        balls && next ? make_lists(tiles, &at, balls, count, next, error) : shape_error_memory(error);
    free(balls);
    free(next);
    return status;
}
