/* Which clouds a view can show: outside it, behind something opaque or below a pixel a cloud costs nothing. */
#include "budget/view.h"

#include <math.h>

#include "shape/imageerror.h"

static const double pi = 3.14159265358979323846;

/* The part of the picture that a cloud's box can touch, in pixels; x0 > x1 where there is none. */
typedef struct window {
    int x0, x1, y0, y1;
} window;

/* Around the projections of the box's corners; the whole picture where a corner is not before the eye. */
static window find_window(const shape_camera *camera, const shape_view *view, shape_dvec3 low,
                          shape_dvec3 high)
{
    double left = INFINITY, right = -INFINITY, top = INFINITY, bottom = -INFINITY;
    double rr = shape_dvec3_dot(camera->right, camera->right), uu = shape_dvec3_dot(camera->up, camera->up);
    const window all = {0, view->width - 1, 0, view->height - 1}, none = {0, -1, 0, -1};
    bool before = false, behind = false;
    for (int i = 0; i < 8; i++) {
        shape_dvec3 corner = {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z};
        shape_dvec3 d = shape_dvec3_sub(corner, camera->origin);
        double ahead = shape_dvec3_dot(d, camera->forward);
        if (!(ahead > 0)) {
            behind = true;
            continue;
        }
        before = true;
        double x = shape_dvec3_dot(d, camera->right) / (ahead * rr);
        double y = shape_dvec3_dot(d, camera->up) / (ahead * uu);
        left = fmin(left, x), right = fmax(right, x), top = fmin(top, -y), bottom = fmax(bottom, -y);
    }
    if (!before)
        return none;
    if (behind)
        return all;
    double w = view->width, h = view->height;
    window found = {
        (int)fmax(floor((left + 1) / 2 * w) - 1, 0), (int)fmin(ceil((right + 1) / 2 * w) + 1, w - 1),
        (int)fmax(floor((top + 1) / 2 * h) - 1, 0), (int)fmin(ceil((bottom + 1) / 2 * h) + 1, h - 1)};
    return found.x0 <= found.x1 && found.y0 <= found.y1 ? found : none;
}

/* Whether the ray meets the cloud's box before anything opaque. */
static bool meets(const shape_volume_cloud *cloud, shape_dvec3 origin, shape_dvec3 direction,
                  const shape_opaque *opaque, bool *behind)
{
    shape_ray ray = shape_volume_ray(cloud, origin, direction);
    float t0 = 0, t1 = INFINITY;
    if (!shape_box_intersect(cloud->box, ray, &t0, &t1))
        return false;
    *behind = shape_opaque_blocks(opaque, origin, direction, (double)t0);
    return !*behind;
}

/* Looks at every pixel of the window, and at those half a pixel aside (a picture of more samples has rays there). */
static shape_budget_sight look(const shape_volume_cloud *cloud, const shape_camera *camera,
                               const shape_view *view, window w, const shape_opaque *opaque)
{
    shape_budget_sight sight = SHAPE_BUDGET_OUTSIDE;
    for (int y = 2 * w.y0; y <= 2 * w.y1 + 2; y++)
        for (int x = 2 * w.x0; x <= 2 * w.x1 + 2; x++) {
            bool behind = false;
            shape_dvec3 d = shape_camera_direction(camera, view, 0.5 * x, 0.5 * y);
            if (meets(cloud, camera->origin, d, opaque, &behind))
                return SHAPE_BUDGET_SEEN;
            if (behind)
                sight = SHAPE_BUDGET_BEHIND;
        }
    return sight;
}

/* A cloud between the pixels' rays: by the ray through its middle. */
static shape_budget_sight look_at_speck(const shape_volume_cloud *cloud, const shape_camera *camera, window w,
                                        const shape_opaque *opaque)
{
    shape_dvec3 middle = {0.5 * ((double)cloud->box.min.x + (double)cloud->box.max.x),
                          0.5 * ((double)cloud->box.min.y + (double)cloud->box.max.y),
                          0.5 * ((double)cloud->box.min.z + (double)cloud->box.max.z)};
    shape_dvec3 way = shape_dvec3_sub(shape_frame_point(&cloud->frame, middle), camera->origin);
    bool behind = false;
    if (w.x0 > w.x1)
        return SHAPE_BUDGET_OUTSIDE;
    meets(cloud, camera->origin, shape_dvec3_normalize(way), opaque, &behind);
    return behind ? SHAPE_BUDGET_BEHIND : SHAPE_BUDGET_SEEN;
}

/* The diameter of the sphere around a box, in pixels; infinite where the eye is near. */
double shape_budget_pixels(const shape_view *view, shape_dvec3 low, shape_dvec3 high)
{
    double across = shape_dvec3_length(shape_dvec3_sub(high, low));
    shape_dvec3 middle = shape_dvec3_scale(shape_dvec3_add(low, high), 0.5);
    double distance = shape_dvec3_length(shape_dvec3_sub(middle, view->eye)) - 0.5 * across;
    double pixel = 2 * tan(view->fov * pi / 360) / view->height * distance;
    return distance > 0 ? across / pixel : INFINITY;
}

/* The largest relative square error of a pixel whose sky is there, or is hidden by white or by black. */
static double most_missed(const shape_sky *sky, shape_dvec3 direction)
{
    float rgb[3];
    double most = 0;
    shape_sky_radiance(sky, shape_vec3_make((float)direction.x, (float)direction.y, (float)direction.z), rgb);
    for (int c = 0; c < 3; c++) {
        double behind = (double)rgb[c], missed = fmax(behind, 1 - behind);
        most = fmax(most, missed * missed / (behind * behind + SHAPE_IMAGEERROR_EPSILON));
    }
    return most;
}

void shape_budget_sights(const shape_volume *volume, const shape_view *view, const shape_light *light,
                         const shape_opaque *opaque, double error, shape_budget_sight *sights)
{
    shape_camera camera = shape_view_camera(view);
    shape_sky sky = shape_sky_make(light);
    double room = 0.1 * error * error * view->width * view->height, missed = 0;
    for (size_t i = 0; i < volume->cloud_count; i++) {
        const shape_volume_cloud *cloud = &volume->clouds[i];
        shape_dvec3 low, high;
        sights[i] = SHAPE_BUDGET_EMPTY;
        if (shape_box_is_empty(cloud->box))
            continue;
        shape_frame_box(&cloud->frame, cloud->box, &low, &high);
        window w = find_window(&camera, view, low, high);
        double across = shape_budget_pixels(view, low, high);
        sights[i] =
            across < 1 ? look_at_speck(cloud, &camera, w, opaque) : look(cloud, &camera, view, w, opaque);
        if (sights[i] != SHAPE_BUDGET_SEEN || !(across < 1))
            continue;
        shape_dvec3 way = shape_dvec3_sub(shape_dvec3_scale(shape_dvec3_add(low, high), 0.5), view->eye);
        double more = across * across * most_missed(&sky, shape_dvec3_normalize(way));
        if (missed + more <= room) {
            sights[i] = SHAPE_BUDGET_TINY;
            missed += more;
        }
    }
}
