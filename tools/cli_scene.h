/* Scenes in the programs: clouds made as a scene says, and --save-scene. */
#ifndef NEPHELE_CLI_SCENE_H
#define NEPHELE_CLI_SCENE_H

#include "cli_generator.h"

/* --save-scene, for generators and neph-edit. */
extern const cli_option cli_save_options[];
/* --save-scene and --allow-outside, for programs that read scenes too. */
extern const cli_option cli_scene_options[];
/* --allow-outside alone. */
extern const cli_option cli_outside_options[];

/* Whether --allow-outside was given. */
bool cli_outside_allowed(void);
/* Ends the program, exit 2, where --save-scene cannot be done with these arguments. */
void cli_save_check(const cli_common *common);
bool cli_save_wanted(void);
/* The file that --save-scene names, or NULL. */
const char *cli_save_path(void);
/* Writes the scene to the file that --save-scene names. */
void cli_save_scene(const shape_scene *scene);
/* A file's name as seen from the folder of that scene; a note says so where it lies outside. The caller frees it. */
char *cli_save_name(const char *path);

/* Makes all clouds of a scene. path is the scene's, for its folder.
 * Mistakes end the program, exit 1. The caller destroys the set. */
shape_set *cli_scene_make(const shape_scene *scene, const char *path);
/* Whether an edit that a panel has made is left to the program that shows it: of the first `clouds` clouds, cli_scene_make
 * leaves the edits out from now on, but checks them. */
void cli_scene_leave_edits(size_t clouds);
/* Edits the clouds from `first` on, as the scene says; see cli_scene_edit.c. */
void cli_scene_edit(const shape_scene *scene, const char *shown, size_t first, shape_set *set);
/* Field and medium of one edit put over those of a cloud; its place and whether it is hidden are the caller's. */
void cli_scene_edit_medium(const shape_scene_edit *edit, const char *place, shape_cloud *cloud);
/* The real path of a file that the scene names, or the program ends; the caller frees it. */
char *cli_scene_file(const char *scene_path, const char *file);

/* What a program was given to show or change. */
typedef struct cli_input {
    const char *path;
    shape_set *set;
    shape_scene *scene;    /* NULL: a .neph, or a volume */
    bool volume;           /* a .vdb or raw floats, read by cli_volume_input_read */
    size_t size;           /* bytes of the file */
    unsigned major, minor; /* of a .neph */
} cli_input;

/* Reads a .neph or a scene, told apart by what is in it, from a path or "-". Mistakes end the program, exit 1. */
cli_input cli_input_read(const char *path);
/* The same from the bytes of a file. */
cli_input cli_input_decode(const char *path, const unsigned char *bytes, size_t size);
void cli_input_free(cli_input *input);
/* A line that says what this program makes of the scene's meshes, where there are any: "not drawn". scene may be NULL. */
void cli_note_meshes(const shape_scene *scene, const char *what);
#endif
