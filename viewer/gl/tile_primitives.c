/* Which primitives of a single cloud a tile of the picture may see, nearest first: the exact view asks these rather than
 * walk the tree in every pixel. Each support is taken as the ball around it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gl_private.h"

enum { TILE = 32, MOST_IN_TILE = 2000 };

typedef struct ball {
    float content, nearest; /* nearest: metres of the world to where a ray can enter at the soonest */
    int x0, y0, x1, y1;     /* tiles, inclusive */
} ball;

/* How much longer than in the cloud's frame a vector can be in the world. */
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

static ball see(const shape_volume_cloud *c, shape_vec3 centre, double radius, float content,
                const shape_view *view, const shape_gl_part *part, const shape_camera *camera)
{
    shape_dvec3 p = shape_frame_point(&c->frame, shape_dvec3_make(centre.x, centre.y, centre.z));
    p = shape_dvec3_sub(p, camera->origin);
    double width = shape_dvec3_length(camera->right), height = shape_dvec3_length(camera->up);
    int columns = (part->width + TILE - 1) / TILE, rows = (part->height + TILE - 1) / TILE;
    ball b = {.content = content};
    double distance = shape_dvec3_length(p), depth = shape_dvec3_dot(p, camera->forward);
    radius = radius * (1 + 1e-4) + 1e-5 * distance; /* single precision in the shader */
    b.nearest = (float)fmax(distance - radius, 0);
    cover_side(shape_dvec3_dot(p, camera->right) / width, depth, radius, width, view->width, part->x, columns,
               &b.x0, &b.x1);
    cover_side(shape_dvec3_dot(p, camera->up) / height, depth, radius, height, view->height, part->y, rows,
               &b.y0, &b.y1);
    return b;
}

static int compare(const void *a, const void *b)
{
    const ball *x = a, *y = b;
    if (x->nearest != y->nearest)
        return x->nearest < y->nearest ? -1 : 1;
    return (x->content > y->content) - (x->content < y->content);
}

static void see_all(const shape_volume_cloud *c, const shape_view *view, const shape_gl_part *part,
                    const shape_camera *camera, ball *balls)
{
    double scale = stretch(&c->frame) * (double)c->support;
    for (size_t i = 0; i < c->list->sphere_count; i++) {
        const shape_sphere *s = &c->list->spheres[i];
        *balls++ = see(c, shape_vec3_make(s->x, s->y, s->z), scale * (double)s->radius, (float)(i + 1), view,
                       part, camera);
    }
    for (size_t i = 0; i < c->list->ellipsoid_count; i++) {
        const shape_ellipsoid *e = &c->list->ellipsoids[i];
        double radius = fmax((double)e->a, fmax((double)e->b, (double)e->c));
        *balls++ =
            see(c, shape_vec3_make(e->x, e->y, e->z), scale * radius, -(float)(i + 1), view, part, camera);
    }
}

/* Writes the lists: counts first, then the entries, in the balls' order. NULL where a list is too long. */
static float *write_lists(const ball *balls, size_t count, int columns, size_t tiles, size_t *texels)
{
    size_t *next = calloc(tiles + 1, sizeof *next), total = 0, longest = 0;
    float *lists = NULL;
    for (size_t i = 0; i < count && next; i++)
        for (int y = balls[i].y0; y <= balls[i].y1; y++)
            for (int x = balls[i].x0; x <= balls[i].x1; x++, total++) {
                size_t length = ++next[y * columns + x];
                longest = length > longest ? length : longest;
            }
    if (next && longest <= MOST_IN_TILE)
        lists = calloc((tiles + total + 1) * 4, sizeof *lists);
    *texels = longest <= MOST_IN_TILE ? tiles + total : 0;
    if (lists) {
        size_t offset = tiles;
        for (size_t i = 0; i < tiles; i++) {
            lists[4 * i] = (float)offset;
            lists[4 * i + 1] = (float)next[i];
            size_t length = next[i];
            next[i] = offset;
            offset += length;
        }
        for (size_t i = 0; i < count; i++)
            for (int y = balls[i].y0; y <= balls[i].y1; y++)
                for (int x = balls[i].x0; x <= balls[i].x1; x++) {
                    float *entry = lists + 4 * next[y * columns + x]++;
                    entry[0] = balls[i].content;
                    entry[1] = balls[i].nearest;
                }
    }
    free(next);
    return lists;
}

shape_status gl_tiles_list_primitives(gl_tiles *tiles, const shape_volume *volume, const shape_view *view,
                                      const shape_gl_part *part, const shape_camera *camera,
                                      shape_error *error)
{
    if (volume->cloud_count != 1 || volume->clouds[0].field.model == SHAPE_MODEL_GRID)
        return SHAPE_OK;
    const shape_volume_cloud *c = &volume->clouds[0];
    size_t count = shape_primitives_count(c->list), texels = 1;
    size_t tile_count = (size_t)tiles->columns * (size_t)((part->height + TILE - 1) / TILE);
    ball *balls = malloc((count + 1) * sizeof *balls);
    float *lists = NULL;
    if (balls) {
        see_all(c, view, part, camera, balls);
        qsort(balls, count, sizeof *balls, compare);
        lists = write_lists(balls, count, tiles->columns, tile_count, &texels);
    }
    shape_status status = balls && (lists || !texels) ? SHAPE_OK : shape_error_memory(error);
    if (lists) {
        tiles->primitives = gl_float_texture(lists, texels, &status, error);
        tiles->listed = !status;
    }
    free(lists);
    free(balls);
    return status;
}
