/* Which clouds a tile of the picture may see: boxes projected to the screen, so that a ray asks only its tile's. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gl_private.h"

enum { TILE = 32 };

typedef struct rectangle {
    int x0, y0, x1, y1; /* tiles, inclusive; empty where x1 < x0 */
} rectangle;

/* The tiles that a cloud's box covers; all of them where a corner is behind the eye. Rows count from below, as
 * gl_FragCoord does. */
static rectangle cover(const shape_volume_cloud *c, const shape_view *view, const shape_gl_part *part,
                       const shape_camera *camera, int columns, int rows)
{
    double low_x = INFINITY, high_x = -INFINITY, low_y = INFINITY, high_y = -INFINITY;
    double right2 = shape_dvec3_dot(camera->right, camera->right),
           up2 = shape_dvec3_dot(camera->up, camera->up);
    for (int corner = 0; corner < 8; corner++) {
        shape_dvec3 p = {corner & 1 ? c->box.max.x : c->box.min.x, corner & 2 ? c->box.max.y : c->box.min.y,
                         corner & 4 ? c->box.max.z : c->box.min.z};
        p = shape_dvec3_sub(shape_frame_point(&c->frame, p), camera->origin);
        double depth = shape_dvec3_dot(p, camera->forward);
        if (!(depth > 1e-9 * shape_dvec3_length(p)))
            return (rectangle){0, 0, columns - 1, rows - 1};
        double x = (shape_dvec3_dot(p, camera->right) / right2 / depth + 1) / 2 * view->width - part->x;
        double y = (shape_dvec3_dot(p, camera->up) / up2 / depth + 1) / 2 * view->height - part->y;
        low_x = fmin(low_x, x), high_x = fmax(high_x, x);
        low_y = fmin(low_y, y), high_y = fmax(high_y, y);
    }
    rectangle r = {(int)fmax(floor((low_x - 1) / TILE), 0), (int)fmax(floor((low_y - 1) / TILE), 0),
                   (int)fmin(floor((high_x + 1) / TILE), columns - 1),
                   (int)fmin(floor((high_y + 1) / TILE), rows - 1)};
    return r;
}

/* The tiles in the order in which they are drawn, as a texture: those without a cloud, with one, with several. */
static shape_status order_tiles(gl_tiles *tiles, int rows, const float *lists, shape_error *error)
{
    int tile_count = tiles->columns * rows, counts[3] = {0}, next[3];
    float *order = calloc((size_t)tile_count * 4 + 4, sizeof *order);
    if (!order)
        return shape_error_memory(error);
    for (int i = 0; i < tile_count; i++)
        counts[(int)fminf(lists[4 * i + 1], 2)]++;
    for (int kind = 0, place = 0; kind < 3; place += counts[kind++])
        next[kind] = place;
    for (int i = 0; i < tile_count; i++) {
        const float *list = lists + 4 * i;
        float *tile = order + 4 * next[(int)fminf(list[1], 2)]++;
        tile[0] = (float)(i % tiles->columns);
        tile[1] = (float)(i / tiles->columns);
        tile[2] = list[1] > 0 ? lists[4 * (size_t)list[0]] : 0;
    }
    tiles->empty_count = counts[0];
    tiles->one_count = counts[1];
    tiles->several_count = counts[2];
    shape_status status = SHAPE_OK;
    tiles->order = gl_float_texture(order, (size_t)tile_count, &status, error);
    free(order);
    return status;
}

shape_status gl_tiles_make(gl_tiles *tiles, const gl_scene *scene, const shape_volume *volume,
                           const shape_view *view, const shape_gl_part *part, const shape_camera *camera,
                           shape_error *error)
{
    int across = (part->width + TILE - 1) / TILE, down = (part->height + TILE - 1) / TILE;
    size_t tile_count = (size_t)across * (size_t)down, total = 0;
    rectangle *covers = malloc(((size_t)scene->shown_count + 1) * sizeof *covers);
    size_t *next = calloc(tile_count + 1, sizeof *next);
    float *texels = NULL;
    shape_status status = SHAPE_OK;
    memset(tiles, 0, sizeof *tiles);
    tiles->columns = across;
    for (int i = 0; covers && next && i < scene->shown_count; i++) {
        covers[i] = cover(&volume->clouds[scene->shown[i]], view, part, camera, across, down);
        for (int y = covers[i].y0; y <= covers[i].y1; y++)
            for (int x = covers[i].x0; x <= covers[i].x1; x++) {
                next[y * across + x]++;
                total++;
            }
    }
    if (covers && next)
        texels = calloc((tile_count + total + 1) * 4, sizeof *texels);
    if (!texels) {
        status = shape_error_memory(error);
    } else {
        size_t offset = tile_count;
        for (size_t i = 0; i < tile_count; i++) {
            texels[4 * i] = (float)offset;
            texels[4 * i + 1] = (float)next[i];
            size_t count = next[i];
            next[i] = offset;
            offset += count;
        }
        for (int i = 0; i < scene->shown_count; i++)
            for (int y = covers[i].y0; y <= covers[i].y1; y++)
                for (int x = covers[i].x0; x <= covers[i].x1; x++)
                    texels[4 * next[y * across + x]++] = (float)i;
        tiles->lists = gl_float_texture(texels, tile_count + total, &status, error);
        if (!status)
            status = order_tiles(tiles, down, texels, error);
    }
    free(covers);
    free(next);
    tiles->texels = texels;
    return status;
}

void gl_tiles_free(gl_tiles *tiles)
{
    glDeleteTextures(1, &tiles->lists);
    glDeleteTextures(1, &tiles->order);
    glDeleteTextures(1, &tiles->primitives);
    free(tiles->texels);
}
