/* Scenes: which clouds and opaque meshes there are and where they stand, with light and camera, as a JSON file.
 * docs/scene.md describes the file. A scene names clouds, by file or by generator and options, and meshes by file; it
 * holds none. Making them is the programs' work (tools/cli_scene.c, tools/opaque_scene.c). */
#ifndef SHAPE_SCENE_H
#define SHAPE_SCENE_H

#include "shape/day.h"
#include "shape/transform.h"
#include "shape/view.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    SHAPE_SCENE_VERSION = 1,
    SHAPE_SCENE_SIZE_MAX = 1 << 24,  /* bytes of a file */
    SHAPE_SCENE_VALUES_MAX = 500000, /* JSON values in it; what is read takes at most about 250 bytes each */
    SHAPE_SCENE_DEPTH_MAX = 8,       /* arrays and objects in one another */
    SHAPE_SCENE_TEXT_MAX = 4096,     /* bytes of a text */
    SHAPE_SCENE_CLOUDS_MAX = 100000, /* clouds, all copies counted, that programs place */
    SHAPE_SCENE_PRIMITIVES_MAX =
        10000000,                  /* primitives that programs hold for one scene; copies share theirs */
    SHAPE_SCENE_EDITS_MAX = 1000,  /* edited clouds */
    SHAPE_SCENE_MESHES_MAX = 1000, /* meshes */
    SHAPE_SCENE_TRIANGLES_MAX = 10000000, /* triangles of all meshes that programs hold for one scene */
};

/* An option of a generator or of the medium, as on a command line without its dashes. */
typedef struct shape_scene_option {
    char *name;
    char *text; /* NULL: a flag, given */
} shape_scene_option;

typedef struct shape_scene_options {
    shape_scene_option *items;
    size_t count, capacity;
} shape_scene_options;

/* One entry of "clouds": a .neph file or what a generator makes, which may be several clouds. */
typedef struct shape_scene_cloud {
    char *name, *note;       /* NULL: none */
    char *file;              /* a .neph, relative to the scene's folder; NULL where a generator is named */
    char *generator, *input; /* a program's name, and the file that it takes or NULL */
    shape_scene_options options; /* the generator's */
    shape_scene_options medium;  /* medium options that override what file or generator say */
    shape_transform place;       /* of all that this entry gives, copies included, after their own places */
    shape_transform *copies;     /* none: it stands once */
    size_t copy_count, copy_capacity;
} shape_scene_cloud;

typedef enum shape_scene_up {
    SHAPE_SCENE_UP_FORMAT, /* y for glTF, GLB and OBJ, z for PLY, STL and OFF */
    SHAPE_SCENE_UP_Y,
    SHAPE_SCENE_UP_Z
} shape_scene_up;

/* One entry of "meshes": an opaque thing (shape/opaque.h). */
typedef struct shape_scene_mesh {
    char *note;            /* NULL: none */
    char *file;            /* OBJ, PLY, STL, OFF, glTF or GLB, relative to the scene's folder */
    shape_scene_up up;     /* which axis of the file is up; default as its format has it */
    double unit;           /* metres a unit of the file, 1e-9 to 1e9; default 1 */
    double albedo[3];      /* share of light that comes back, 0 to 1; default 0.5 */
    shape_transform place; /* after axes and unit; keep_depth is not used */
} shape_scene_mesh;

/* One entry of "edits": a cloud of the scene, after all are made, by its name; each may be edited once. */
typedef struct shape_scene_edit {
    char *note;                     /* NULL: none */
    char *cloud;                    /* its name, as neph-info tells it */
    shape_scene_options medium;     /* medium options over those that it has */
    double translate[3], rotate[3]; /* metres; degrees about x, then y, then z */
    double scale;                   /* 1e-6 to 1e6; both this and rotate about the cloud's own origin */
    bool hidden;                    /* it is left out */
} shape_scene_edit;

/* What is not given is left to the program, whose defaults docs/scene.md repeats. */
typedef struct shape_scene {
    char *note;
    shape_scene_cloud *clouds;
    size_t cloud_count, cloud_capacity;
    shape_scene_mesh *meshes;
    size_t mesh_count, mesh_capacity;
    bool ground_given;
    double ground, ground_albedo[3]; /* level ground, as opaque as meshes: its height [m], +-1e6; 0 to 1 */
    shape_scene_options medium;      /* overrides for all clouds, before each entry's own */
    shape_scene_edit *edits;
    size_t edit_count, edit_capacity;
    shape_scene_options
        view;      /* options of neph-view: method, quality, what moves, what is shown for judging */
    char *compare; /* a file that neph-view shows right of the first; NULL: none */

    bool sun_given, sun_none, sun_irradiance_given, sun_angle_given;
    double sun[2];            /* azimuth from +z towards +x, height; degrees; +-360, +-90 */
    double sun_irradiance[3]; /* on a plane that faces it, 0 to 1e9 */
    double sun_angle;         /* diameter, degrees, 0 to 90 */
    bool
        day_given; /* the sun goes by the time of day, and the irradiance is what the air has not taken yet */
    shape_day day;

    bool lamp_given;
    double lamp[3];           /* a lamp's place [m], +-1e12 */
    double lamp_intensity[3]; /* irradiance times distance squared, alike in all directions, 0 to 1e18 */

    bool sky_given;
    shape_sky_kind sky;
    double sky_radiance[3]; /* of SHAPE_SKY_CONSTANT, 0 to 1e9 */

    bool air_given;
    double visibility; /* of the air [m], 0.001 to 1e12 */
    double air_height; /* over which it thins by a factor e [m], 0.001 to 1e12; 0: alike at all heights */

    bool eye_given, target_given, fov_given, size_given, exposure_given;
    double eye[3], target[3]; /* [m], +-1e12 */
    double fov;               /* vertical, degrees, 0.001 to 179 */
    int size[2];              /* pixels, 1 to 16384 */
    double exposure;          /* stops, +-32 */
} shape_scene;

/* An empty scene. The caller destroys it, and with it all texts and arrays in it; NULL and *error where memory is out. */
shape_scene *shape_scene_create(shape_error *error);
void shape_scene_destroy(shape_scene *scene); /* NULL is allowed */
/* Adds an entry with nothing in it but an identity place. Pointers into scene->clouds end with the call. */
shape_status shape_scene_add_cloud(shape_scene *scene, shape_scene_cloud **cloud, shape_error *error);
/* Adds a mesh with the defaults above and no file. Pointers into scene->meshes end with the call. */
shape_status shape_scene_add_mesh(shape_scene *scene, shape_scene_mesh **mesh, shape_error *error);
/* Adds an edit of a cloud by its name that changes nothing yet. Pointers into scene->edits end with the call. */
shape_status shape_scene_add_edit(shape_scene *scene, const char *cloud, shape_scene_edit **edit,
                                  shape_error *error);
/* Takes all edits away, and all options of a list. */
void shape_scene_clear_edits(shape_scene *scene);
void shape_scene_clear_options(shape_scene_options *options);
/* The text of an option; NULL where it is not there or a flag. */
const char *shape_scene_find_option(const shape_scene_options *options, const char *name);
/* The whole placement of a mesh, from units of its file to metres of the world; z_up: what its format has as up, for
 * SHAPE_SCENE_UP_FORMAT. */
shape_frame shape_scene_mesh_frame(const shape_scene_mesh *mesh, bool z_up);
/* Adds a placed copy. */
shape_status shape_scene_add_copy(shape_scene_cloud *cloud, const shape_transform *place, shape_error *error);
/* Adds an option; both texts are copied, text may be NULL for a flag. */
shape_status shape_scene_add_option(shape_scene_options *options, const char *name, const char *text,
                                    shape_error *error);
/* Replaces *member, a text of a scene, by a copy of text. */
shape_status shape_scene_set_text(char **member, const char *text, shape_error *error);

/* The text of a picture under which a scene is kept in it (shape_image_text), so that the picture can be opened as one. */
#define SHAPE_SCENE_PICTURE_KEY "nephele-scene"
/* Whether these bytes begin as a PNG or an EXR does. */
bool shape_scene_is_picture(const void *bytes, size_t size);

/* Whether these bytes look like a scene and not like a .neph: the first that is no blank is a brace; or it is a picture. */
bool shape_scene_is(const void *bytes, size_t size);

/* Reads untrusted JSON. name stands before every error: "name:line:column: ..." where it is no JSON,
 * "name: clouds[2].scale: ..." where a value is wrong. Unknown keys, keys twice, wrong types and values outside their ranges are
 * errors (SHAPE_ERROR_FORMAT), and so is what passes a limit above (SHAPE_ERROR_LIMIT). Options are
 * kept as texts: their names and values are the generators' to check. Of a PNG or EXR, the scene that it holds is read;
 * where it holds none, that is an error, too. */
shape_status shape_scene_decode(const void *bytes, size_t size, const char *name, shape_scene **scene,
                                shape_error *error);
/* The scene as JSON, which shape_scene_decode reads to an equal one. The caller frees *text. Errors: memory; whatever
 * shape_scene_decode would refuse. */
shape_status shape_scene_encode(const shape_scene *scene, char **text, size_t *size, shape_error *error);

/* The path of a file that a scene names, for opening. scene_path is the scene's own, "-" for standard input, whose folder
 * is the current one. Unless allow_outside, a name that is absolute or climbs by "..", and a link that leads out of the scene's
 * folder, are SHAPE_ERROR_ARGUMENT; what is no regular file is SHAPE_ERROR_IO. The caller frees *path. */
shape_status shape_scene_find_file(const char *scene_path, const char *file, bool allow_outside, char **path,
                                   shape_error *error);
/* The reverse, for writing: path as seen from the folder of scene_path, with *outside telling that it climbs out of
 * it. Both folders must exist. The caller frees *file. */
shape_status shape_scene_relative(const char *scene_path, const char *path, char **file, bool *outside,
                                  shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
