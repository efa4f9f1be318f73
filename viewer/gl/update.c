/* What an edit leaves of light and baked density: clouds are compared one by one with those that were loaded before, and where
 * few primitives have changed, voxels and the sun's light are made again only there, at once. The scattered light couples
 * everything: it stays as it was for a moment, and is made again on the thread (refine.c). */
#include <stdlib.h>
#include <string.h>

#include "gl_private.h"

void gl_update_free(gl_update *update)
{
    for (size_t i = 0; update->changes && i < update->count; i++)
        shape_change_free(&update->changes[i]);
    free(update->changes);
    free(update->replaced);
    free(update->shaded);
    memset(update, 0, sizeof *update);
}

static bool same_place(const shape_volume_cloud *a, const shape_volume_cloud *b)
{
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++)
            if (a->frame.m[i][k] != b->frame.m[i][k])
                return false;
    const shape_medium *m = &a->medium, *n = &b->medium;
    return m->extinction == n->extinction && m->albedo == n->albedo && m->phase == n->phase && m->g == n->g &&
           m->g2 == n->g2 && m->lobe_mix == n->lobe_mix && m->droplet == n->droplet;
}

/* A cloud's light is another one, and that of all on which it throws a shadow, or threw one. */
static void mark_shaded(gl_update *u, const shape_volume *old, shape_dvec3 sun, size_t caster)
{
    u->shaded[caster] = true;
    for (size_t i = 0; i < u->count; i++)
        if (!u->shaded[i])
            u->shaded[i] = shape_sun_may_shade(&old->clouds[caster], &old->clouds[i], sun) ||
                           shape_sun_may_shade(&u->volume->clouds[caster], &u->volume->clouds[i], sun);
}

static bool compare(gl_update *u, const shape_volume *old, shape_dvec3 sun)
{
    u->changes = calloc(u->count + 1, sizeof *u->changes);
    u->replaced = calloc(u->count + 1, sizeof *u->replaced);
    u->shaded = calloc(u->count + 1, sizeof *u->shaded);
    if (!u->changes || !u->replaced || !u->shaded)
        return false;
    for (size_t i = 0; i < u->count; i++) {
        const shape_volume_cloud *before = &old->clouds[i], *after = &u->volume->clouds[i];
        if (shape_change_find(before, after, &u->changes[i], NULL))
            return false;
        u->replaced[i] = !same_place(before, after);
    }
    for (size_t i = 0; i < u->count; i++)
        if (u->replaced[i] || shape_change_is_any(&u->changes[i]))
            mark_shaded(u, old, sun, i);
    return true;
}

/* Compares; false where grids may not stay, also where memory is out. */
static bool find(const shape_gl_renderer *r, const shape_volume *volume, gl_update *u)
{
    memset(u, 0, sizeof *u);
    /* What has been loaded and not been drawn has grids of something else. */
    if (r->update.pending || r->options.method != SHAPE_GL_DEFAULT || !r->options.background ||
        !r->grids.light || !r->grids.baked || !r->volume || r->volume->cloud_count != volume->cloud_count)
        return false;
    u->volume = volume;
    u->count = volume->cloud_count;
    if (compare(u, r->volume, r->light.sun))
        return true;
    gl_update_free(u);
    return false;
}

bool gl_update_begin(shape_gl_renderer *r, const shape_volume *volume)
{
    gl_update u;
    bool stays = find(r, volume, &u);
    gl_update_free(&r->update);
    r->update = u;
    r->update.pending = stays;
    return stays;
}

bool shape_gl_stays(const shape_gl_renderer *r, const shape_volume *volume)
{
    gl_update u;
    bool stays = find(r, volume, &u);
    for (size_t i = 0; i < u.count; i++)
        stays = stays && !u.replaced[i] && !u.changes[i].all;
    gl_update_free(&u);
    return stays;
}

/* Voxels of one cloud, in place. */
static shape_status bake_again(shape_gl_renderer *r, const gl_order *order, size_t i, shape_error *error)
{
    gl_dense *dense = r->grids.baked->dense[i];
    uint8_t *bricks;
    int size[3];
    memcpy(size, dense->baked.size, sizeof size);
    shape_status status = shape_bake_again(&r->volume->clouds[i], &r->update.changes[i], order->threads,
                                           order->stop, &dense->baked, &bricks, error);
    if (!status) {
        gl_pool_patch(&r->pool, dense, bricks, &r->costs.baked_bytes);
        r->costs.rebaked_clouds++;
        free(bricks);
        return SHAPE_OK;
    }
    memcpy(dense->baked.size, size, sizeof size); /* so much room it still has in the pool */
    dense->sent = 0;
    return status;
}

static void drop_dense(shape_gl_renderer *r, size_t i)
{
    gl_dense_drop(r->grids.baked->dense[i]);
    r->grids.baked->dense[i] = NULL;
}

static shape_status bake_all_again(shape_gl_renderer *r, const gl_order *order, shape_error *error)
{
    shape_status status = SHAPE_OK;
    for (size_t i = 0; i < r->update.count; i++) {
        const shape_change *change = &r->update.changes[i];
        gl_dense *dense = r->grids.baked->dense[i];
        if (!dense || !shape_change_is_any(change))
            continue;
        if (!change->all && !status)
            status = bake_again(r, order, i, error);
        if (change->all || status)
            drop_dense(r, i);
    }
    const gl_baked *const sets[] = {r->grids.baked};
    gl_pool_keep(&r->pool, sets, 1);
    return status;
}

static shape_status light_again(shape_gl_renderer *r, const gl_order *order, shape_error *error)
{
    gl_order again = *order;
    gl_light *light;
    again.want_light = again.lenient = true;
    again.light_from = r->grids.light;
    again.update = &r->update;
    shape_status status = gl_light_make(&again, &light, error);
    if (status)
        return status;
    r->costs.relit_clouds += (size_t)light->made;
    gl_light_drop(r->grids.light);
    r->grids.light = light;
    return SHAPE_OK;
}

shape_status gl_update_do(shape_gl_renderer *r, const gl_order *order, shape_error *error)
{
    shape_status status = bake_all_again(r, order, error);
    if (!status && !r->light_changed)
        status = light_again(r, order, error);
    if (status) { /* what there is may be of either volume */
        gl_grids_drop(&r->grids);
        gl_pool_free(&r->pool);
    }
    gl_update_free(&r->update);
    return status;
}
