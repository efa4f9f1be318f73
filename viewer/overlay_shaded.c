/* Primitives as shaded ellipsoids over the picture: of each the half that faces the eye, as rings of triangles, lit by the sun;
 * far ones first, so that near ones lie on them. Where two pass through each other the nearer middle wins. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "panel.h"
#include "shape/transform.h"
#include "shape/view.h"

enum { MOST_PRIMITIVES = 3000, AROUND = 14, RINGS = 3, CORNERS = 1 + RINGS * AROUND };
#define PI 3.14159265358979323846

/* A primitive in the world: its middle, and its semi-axes as vectors. */
typedef struct solid {
    shape_dvec3 centre, axis[3];
    double depth;
} solid;

static shape_dvec3 vector_by(const shape_frame *frame, shape_dvec3 v)
{
    shape_dvec3 origin = shape_frame_point(frame, shape_dvec3_make(0, 0, 0));
    return shape_dvec3_sub(shape_frame_point(frame, v), origin);
}

static solid make_solid(const shape_frame *frame, const shape_ellipsoid *e, const shape_camera *camera)
{
    double m[3][3];
    solid s = {.centre =
                   shape_frame_point(frame, shape_dvec3_make((double)e->x, (double)e->y, (double)e->z))};
    shape_quat_matrix(e->q, m);
    for (int i = 0; i < 3; i++)
        s.axis[i] = vector_by(
            frame, shape_dvec3_scale(shape_dvec3_make(m[0][i], m[1][i], m[2][i]), (double)(&e->a)[i]));
    s.depth = shape_dvec3_dot(shape_dvec3_sub(s.centre, camera->origin), camera->forward);
    return s;
}

static int compare_depths(const void *a, const void *b)
{
    double x = ((const solid *)a)->depth, y = ((const solid *)b)->depth;
    return (x < y) - (x > y);
}

/* All that lies before the eye, the farthest first. */
static solid *collect(const shape_set *set, const shape_camera *camera, size_t *count)
{
    solid *all = malloc(MOST_PRIMITIVES * sizeof *all);
    *count = 0;
    for (size_t i = 0; all && i < set->cloud_count; i++) {
        const shape_primitives *list = shape_set_list_const(set, i);
        size_t spheres = list->sphere_count, here = shape_primitives_count(list);
        for (size_t k = 0; k < here && *count < MOST_PRIMITIVES; k++) {
            shape_ellipsoid e =
                k < spheres ? shape_ellipsoid_from_sphere(&list->spheres[k]) : list->ellipsoids[k - spheres];
            solid s = make_solid(&set->clouds[i].frame, &e, camera);
            if (s.depth > 1e-3)
                all[(*count)++] = s;
        }
    }
    if (all)
        qsort(all, *count, sizeof *all, compare_depths);
    return all;
}

/* --- one ellipsoid --- */

typedef struct shading {
    shape_camera camera;
    shape_dvec3 sun;
    double right2, up2;
    float width, height;
} shading;

static shape_dvec3 cross(shape_dvec3 a, shape_dvec3 b)
{
    return shape_dvec3_make(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

/* Where the unit sphere that the ellipsoid is made of faces the eye. */
static shape_dvec3 facing(const solid *s, shape_dvec3 eye)
{
    shape_dvec3 d = shape_dvec3_sub(eye, s->centre);
    shape_dvec3 n =
        shape_dvec3_make(shape_dvec3_dot(d, s->axis[0]) / shape_dvec3_dot(s->axis[0], s->axis[0]),
                         shape_dvec3_dot(d, s->axis[1]) / shape_dvec3_dot(s->axis[1], s->axis[1]),
                         shape_dvec3_dot(d, s->axis[2]) / shape_dvec3_dot(s->axis[2], s->axis[2]));
    double length = shape_dvec3_length(n);
    return length > 0 ? shape_dvec3_scale(n, 1 / length) : shape_dvec3_make(0, 0, 1);
}

/* A corner at n of the unit sphere: its place on the screen, and how bright it is; false behind the eye. */
static bool corner(const shading *to, const solid *s, const double n[3], float at[2], unsigned *colour)
{
    shape_dvec3 p = s->centre, normal = {0, 0, 0};
    for (int i = 0; i < 3; i++) {
        p = shape_dvec3_add(p, shape_dvec3_scale(s->axis[i], n[i]));
        normal = shape_dvec3_add(
            normal, shape_dvec3_scale(s->axis[i], n[i] / shape_dvec3_dot(s->axis[i], s->axis[i])));
    }
    shape_dvec3 d = shape_dvec3_sub(p, to->camera.origin);
    double depth = shape_dvec3_dot(d, to->camera.forward);
    if (!(depth > 1e-3 * shape_dvec3_length(d)))
        return false;
    at[0] = (float)(shape_dvec3_dot(d, to->camera.right) / to->right2 / depth + 1) / 2 * to->width;
    at[1] = (float)(1 - shape_dvec3_dot(d, to->camera.up) / to->up2 / depth) / 2 * to->height;
    double lit = shape_dvec3_dot(normal, to->sun) / fmax(shape_dvec3_length(normal), 1e-30);
    unsigned grey = (unsigned)(70 + 170 * fmax(lit, 0));
    unsigned red = grey, green = grey, blue = grey + 15;
    *colour = red | green << 8 | blue << 16 | 0xf0u << 24;
    return true;
}

static void add_solid(view_solids *solids, const shading *to, const solid *s)
{
    shape_dvec3 d = facing(s, to->camera.origin);
    shape_dvec3 side = fabs(d.y) < 0.9 ? shape_dvec3_make(0, 1, 0) : shape_dvec3_make(1, 0, 0),
                u = cross(side, d);
    u = shape_dvec3_scale(u, 1 / shape_dvec3_length(u));
    shape_dvec3 v = cross(d, u);
    view_corner *first = &solids->corners[solids->count * CORNERS];
    for (int i = 0; i < CORNERS; i++) {
        int ring = i ? (i - 1) / AROUND + 1 : 0;
        double turn = 2 * PI * ((i - 1) % AROUND) / AROUND, angle = PI / 2 * ring / RINGS, r = sin(angle),
               h = cos(angle);
        double a = r * cos(turn), b = r * sin(turn);
        const double n[3] = {h * d.x + a * u.x + b * v.x, h * d.y + a * u.y + b * v.y,
                             h * d.z + a * u.z + b * v.z};
        if (!corner(to, s, n, first[i].at, &first[i].colour))
            return; /* the eye is within it, or nearly */
    }
    solids->count++;
}

void view_solids_make(view_solids *solids, const view_state *state, const shape_set *set, float width,
                      float height)
{
    shape_view view = view_state_view(state, (int)width, (int)height);
    shape_light light = view_state_light(state);
    shading to = {.camera = shape_view_camera(&view), .sun = light.sun, .width = width, .height = height};
    size_t count;
    to.right2 = shape_dvec3_dot(to.camera.right, to.camera.right);
    to.up2 = shape_dvec3_dot(to.camera.up, to.camera.up);
    memset(solids, 0, sizeof *solids);
    solid *all = collect(set, &to.camera, &count);
    solids->corners = all ? malloc((count + 1) * CORNERS * sizeof *solids->corners) : NULL;
    for (size_t i = 0; solids->corners && i < count; i++)
        add_solid(solids, &to, &all[i]);
    free(all);
}

void view_solids_free(view_solids *solids)
{
    free(solids->corners);
    memset(solids, 0, sizeof *solids);
}

int view_solid_corners(void)
{
    return CORNERS;
}

int view_solid_triangles(int (*triangles)[3])
{
    int count = 0;
    for (int ring = 0; ring < RINGS; ring++)
        for (int i = 0; i < AROUND; i++) {
            int next = (i + 1) % AROUND, out = 1 + ring * AROUND, in = out - AROUND;
            const int outer[3] = {ring ? in + i : 0, out + i, out + next};
            memcpy(triangles[count++], outer, sizeof outer);
            if (!ring)
                continue;
            const int inner[3] = {in + i, out + next, in + next};
            memcpy(triangles[count++], inner, sizeof inner);
        }
    return count;
}
