/* Scenes to JSON (docs/scene.md), laid out for people: short things in one line, a line for each copy. */
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "file/neph_layout.h"
#include "file/scene_private.h"
#include "shape/scene.h"

/* Between two members of an object. */
typedef struct writer {
    FILE *out;
    bool bad_text;  /* a text was no UTF-8 */
    bool no_memory; /* for a text */
} writer;

static void put_number(writer *w, double value)
{
    char text[SCENE_NUMBER_MAX];
    scene_number_text(value, text);
    fputs(text, w->out);
}

static void put_three(writer *w, const double v[3])
{
    for (int i = 0; i < 3; i++) {
        fputs(i ? ", " : "[", w->out);
        put_number(w, v[i]);
    }
    fputc(']', w->out);
}

/* One number where all agree. */
static void put_one_or_three(writer *w, const double v[3])
{
    if (v[0] == v[1] && v[1] == v[2])
        put_number(w, v[0]);
    else
        put_three(w, v);
}

static void put_text(writer *w, const char *text)
{
    json_t *string = json_string(text);
    if (!string || json_dumpf(string, w->out, JSON_ENCODE_ANY)) {
        bool good = neph_text_is_plain(text, strlen(text));
        w->no_memory = w->no_memory || good;
        w->bad_text = w->bad_text || !good;
    }
    json_decref(string);
}

/* A key, and a comma before it where something stands there already. */
static void put_key(writer *w, bool *first, const char *between, const char *key)
{
    fprintf(w->out, "%s%s", *first ? "" : ",", between + (*first && *between == ' '));
    put_text(w, key);
    fputs(": ", w->out);
    *first = false;
}

/* "3.8,1.7,3.7" as [3.8, 1.7, 3.7], where that reads back as the same text. */
static bool put_list(writer *w, const char *text)
{
    char part[3][SCENE_NUMBER_MAX];
    int count = 0;
    for (const char *from = text;; count++) {
        size_t length = strcspn(from, ",");
        if (count == 3 || length >= SCENE_NUMBER_MAX)
            return false;
        memcpy(part[count], from, length);
        part[count][length] = 0;
        if (!scene_number_is_plain(part[count]))
            return false;
        if (!from[length])
            break;
        from += length + 1;
    }
    if (!count++)
        return false;
    for (int i = 0; i < count; i++)
        fprintf(w->out, "%s%s", i ? ", " : "[", part[i]);
    fputc(']', w->out);
    return true;
}

static void put_options(writer *w, const shape_scene_options *options)
{
    bool first = true;
    fputc('{', w->out);
    for (size_t i = 0; i < options->count; i++) {
        const shape_scene_option *option = &options->items[i];
        put_key(w, &first, " ", option->name);
        if (!option->text)
            fputs("true", w->out);
        else if (scene_number_is_plain(option->text))
            fputs(option->text, w->out);
        else if (!put_list(w, option->text))
            put_text(w, option->text);
    }
    fputc('}', w->out);
}

/* The members of a place that say anything. */
static void put_place(writer *w, const shape_transform *place, bool *first, const char *between)
{
    const double *t = place->translate, *r = place->rotate, *s = place->scale;
    if (t[0] != 0 || t[1] != 0 || t[2] != 0) {
        put_key(w, first, between, "translate");
        put_three(w, t);
    }
    if (r[0] != 0 || r[1] != 0 || r[2] != 0) {
        put_key(w, first, between, "rotate");
        put_three(w, r);
    }
    if (s[0] != 1 || s[1] != 1 || s[2] != 1) {
        put_key(w, first, between, "scale");
        put_one_or_three(w, s);
    }
    if (place->mirror[0] || place->mirror[1] || place->mirror[2]) {
        put_key(w, first, between, "mirror");
        fprintf(w->out, "\"%s%s%s\"", place->mirror[0] ? "x" : "", place->mirror[1] ? "y" : "",
                place->mirror[2] ? "z" : "");
    }
    if (place->keep_depth) {
        put_key(w, first, between, "keep-depth");
        fputs("true", w->out);
    }
}

static void put_cloud(writer *w, const shape_scene_cloud *cloud)
{
    static const char *const between = "\n      ";
    const struct {
        const char *key, *text;
    } texts[] = {{"note", cloud->note},
                 {"name", cloud->name},
                 {"file", cloud->file},
                 {"generator", cloud->generator},
                 {"input", cloud->input}};
    bool first = true;
    fputs("\n    {", w->out);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        if (texts[i].text) {
            put_key(w, &first, between, texts[i].key);
            put_text(w, texts[i].text);
        }
    if (cloud->options.count) {
        put_key(w, &first, between, "options");
        put_options(w, &cloud->options);
    }
    if (cloud->medium.count) {
        put_key(w, &first, between, "medium");
        put_options(w, &cloud->medium);
    }
    put_place(w, &cloud->place, &first, between);
    if (cloud->copy_count) {
        put_key(w, &first, between, "copies");
        for (size_t i = 0; i < cloud->copy_count; i++) {
            bool none = true;
            fputs(i ? ",\n        {" : "[\n        {", w->out);
            put_place(w, &cloud->copies[i], &none, " ");
            fputc('}', w->out);
        }
        fputs("\n      ]", w->out);
    }
    fputs("\n    }", w->out);
}

static void put_mesh(writer *w, const shape_scene_mesh *mesh)
{
    static const char *const between = "\n      ";
    static const double usual[3] = {0.5, 0.5, 0.5};
    bool first = true;
    fputs("\n    {", w->out);
    if (mesh->note) {
        put_key(w, &first, between, "note");
        put_text(w, mesh->note);
    }
    put_key(w, &first, between, "file");
    put_text(w, mesh->file ? mesh->file : "");
    if (mesh->up != SHAPE_SCENE_UP_FORMAT) {
        put_key(w, &first, between, "up");
        put_text(w, mesh->up == SHAPE_SCENE_UP_Y ? "y" : "z");
    }
    if (mesh->unit != 1) {
        put_key(w, &first, between, "unit");
        put_number(w, mesh->unit);
    }
    if (memcmp(mesh->albedo, usual, sizeof usual)) {
        put_key(w, &first, between, "albedo");
        put_one_or_three(w, mesh->albedo);
    }
    put_place(w, &mesh->place, &first, between);
    fputs("\n    }", w->out);
}

static void put_meshes(writer *w, const shape_scene *scene, bool *first)
{
    if (!scene->mesh_count)
        return;
    put_key(w, first, "\n  ", "meshes");
    fputc('[', w->out);
    for (size_t i = 0; i < scene->mesh_count; i++) {
        fputs(i ? "," : "", w->out);
        put_mesh(w, &scene->meshes[i]);
    }
    fputs("\n  ]", w->out);
}

static void put_ground(writer *w, const shape_scene *scene, bool *first)
{
    if (!scene->ground_given)
        return;
    put_key(w, first, "\n  ", "ground");
    fputs("{\"height\": ", w->out);
    put_number(w, scene->ground);
    fputs(", \"albedo\": ", w->out);
    put_one_or_three(w, scene->ground_albedo);
    fputc('}', w->out);
}

static void put_edit(writer *w, const shape_scene_edit *edit)
{
    bool first = true;
    shape_transform place = {.scale = {edit->scale, edit->scale, edit->scale}};
    memcpy(place.translate, edit->translate, sizeof place.translate);
    memcpy(place.rotate, edit->rotate, sizeof place.rotate);
    fputs("\n    {", w->out);
    if (edit->note) {
        put_key(w, &first, " ", "note");
        put_text(w, edit->note);
    }
    put_key(w, &first, " ", "cloud");
    put_text(w, edit->cloud ? edit->cloud : "");
    if (edit->medium.count) {
        put_key(w, &first, " ", "medium");
        put_options(w, &edit->medium);
    }
    put_place(w, &place, &first, " ");
    if (edit->hidden) {
        put_key(w, &first, " ", "hidden");
        fputs("true", w->out);
    }
    fputc('}', w->out);
}

static void put_edits(writer *w, const shape_scene *scene, bool *first)
{
    if (!scene->edit_count)
        return;
    put_key(w, first, "\n  ", "edits");
    fputc('[', w->out);
    for (size_t i = 0; i < scene->edit_count; i++) {
        fputs(i ? "," : "", w->out);
        put_edit(w, &scene->edits[i]);
    }
    fputs("\n  ]", w->out);
}

static void put_sun(writer *w, const shape_scene *scene, bool *first)
{
    bool none = true;
    if (!scene->sun_none && !scene->sun_given && !scene->sun_irradiance_given && !scene->sun_angle_given &&
        !scene->day_given)
        return;
    put_key(w, first, "\n  ", "sun");
    if (scene->sun_none) {
        fputs("\"none\"", w->out);
        return;
    }
    fputc('{', w->out);
    if (scene->sun_given) {
        put_key(w, &none, " ", "azimuth");
        put_number(w, scene->sun[0]);
        put_key(w, &none, " ", "height");
        put_number(w, scene->sun[1]);
    }
    if (scene->sun_irradiance_given) {
        put_key(w, &none, " ", "irradiance");
        put_three(w, scene->sun_irradiance);
    }
    if (scene->sun_angle_given) {
        put_key(w, &none, " ", "angle");
        put_number(w, scene->sun_angle);
    }
    if (scene->day_given) {
        put_key(w, &none, " ", "day");
        fputs("{\"hour\": ", w->out);
        put_number(w, scene->day.hour);
        fputs(", \"latitude\": ", w->out);
        put_number(w, scene->day.latitude);
        fputs(", \"declination\": ", w->out);
        put_number(w, scene->day.declination);
        fputc('}', w->out);
    }
    fputc('}', w->out);
}

static void put_light(writer *w, const shape_scene *scene, bool *first)
{
    put_sun(w, scene, first);
    if (scene->lamp_given) {
        put_key(w, first, "\n  ", "lamp");
        fputs("{\"position\": ", w->out);
        put_three(w, scene->lamp);
        fputs(", \"intensity\": ", w->out);
        put_three(w, scene->lamp_intensity);
        fputc('}', w->out);
    }
    if (scene->sky_given) {
        put_key(w, first, "\n  ", "sky");
        if (scene->sky == SHAPE_SKY_CONSTANT)
            put_three(w, scene->sky_radiance);
        else
            put_text(w, scene->sky == SHAPE_SKY_NONE ? "none" : "clear");
    }
    if (scene->air_given) {
        put_key(w, first, "\n  ", "air");
        fputs("{\"visibility\": ", w->out);
        put_number(w, scene->visibility);
        if (scene->air_height > 0) {
            fputs(", \"height\": ", w->out);
            put_number(w, scene->air_height);
        }
        fputc('}', w->out);
    }
}

static void put_camera(writer *w, const shape_scene *scene, bool *first)
{
    bool none = true;
    if (!scene->eye_given && !scene->target_given && !scene->fov_given && !scene->size_given)
        return;
    put_key(w, first, "\n  ", "camera");
    fputc('{', w->out);
    if (scene->eye_given) {
        put_key(w, &none, " ", "eye");
        put_three(w, scene->eye);
    }
    if (scene->target_given) {
        put_key(w, &none, " ", "target");
        put_three(w, scene->target);
    }
    if (scene->fov_given) {
        put_key(w, &none, " ", "fov");
        put_number(w, scene->fov);
    }
    if (scene->size_given) {
        put_key(w, &none, " ", "size");
        fprintf(w->out, "[%d, %d]", scene->size[0], scene->size[1]);
    }
    fputc('}', w->out);
}

static void put_scene(writer *w, const shape_scene *scene)
{
    static const char *const between = "\n  ";
    bool first = true;
    fputc('{', w->out);
    put_key(w, &first, between, "scene");
    fprintf(w->out, "%d", SHAPE_SCENE_VERSION);
    if (scene->note) {
        put_key(w, &first, between, "note");
        put_text(w, scene->note);
    }
    put_key(w, &first, between, "clouds");
    fputc('[', w->out);
    for (size_t i = 0; i < scene->cloud_count; i++) {
        fputs(i ? "," : "", w->out);
        put_cloud(w, &scene->clouds[i]);
    }
    fputs(scene->cloud_count ? "\n  ]" : "]", w->out);
    put_meshes(w, scene, &first);
    put_ground(w, scene, &first);
    if (scene->medium.count) {
        put_key(w, &first, between, "medium");
        put_options(w, &scene->medium);
    }
    put_edits(w, scene, &first);
    put_light(w, scene, &first);
    put_camera(w, scene, &first);
    if (scene->exposure_given) {
        put_key(w, &first, between, "exposure");
        put_number(w, scene->exposure);
    }
    if (scene->view.count) {
        put_key(w, &first, between, "view");
        put_options(w, &scene->view);
    }
    if (scene->compare) {
        put_key(w, &first, between, "compare");
        put_text(w, scene->compare);
    }
    fputs("\n}\n", w->out);
}

shape_status shape_scene_encode(const shape_scene *scene, char **text, size_t *size, shape_error *error)
{
    char *made = NULL;
    size_t length = 0;
    writer w = {.out = open_memstream(&made, &length)};
    if (!w.out)
        return shape_error_memory(error);
    put_scene(&w, scene);
    bool failed = ferror(w.out) || w.no_memory;
    failed = fclose(w.out) || failed;
    shape_status status = SHAPE_OK;
    if (failed)
        status = shape_error_memory(error);
    else if (w.bad_text)
        status = shape_error_set(error, SHAPE_ERROR_ARGUMENT,
                                 "the scene has a text that is no UTF-8 (rename the file)");
    shape_scene *again = NULL;
    if (!status) /* the reader's checks are the writer's */
        status = shape_scene_decode(made, length, "the scene", &again, error);
    shape_scene_destroy(again);
    if (status) {
        free(made);
        return status;
    }
    *text = made;
    *size = length;
    return SHAPE_OK;
}
