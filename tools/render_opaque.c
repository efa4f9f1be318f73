/* Opaque meshes: those that the scene names, then those of the command line, as they are placed in their files, in metres.
 * PLY, STL and OFF are taken as z up, as by neph-mesh. */
#include "render_opaque.h"

#include <stdio.h>
#include <string.h>

#include "opaque_scene.h"

static cli_texts meshes, colours;
static double ground, ground_colour[3] = {0.2, 0.2, 0.2};
static bool ground_given;

const cli_option render_opaque_options[] = {
    {"mesh", 0, CLI_TEXTS, &meshes, 0, 0, "FILE",
     "an opaque thing beside those of the scene: OBJ, PLY, STL, OFF, glTF or GLB, in metres; may be given "
     "again [none]",
     NULL, false},
    {"mesh-colour", 0, CLI_TEXTS, &colours, 0, 0, "R,G,B",
     "share of light that the first, second ... --mesh gives back, 0 to 1 [0.5,0.5,0.5]", NULL, false},
    {"ground", 0, CLI_NUMBER, &ground, -1e6, 1e6, "HEIGHT",
     "level ground as far as one sees, at that height, metres [none]", &ground_given, false},
    {"ground-colour", 0, CLI_VECTOR, ground_colour, 0, 1, "R,G,B",
     "share of light that it gives back [0.2,0.2,0.2]", NULL, false},
    {0}};

bool render_opaque_given(void)
{
    return meshes.count > 0 || ground_given;
}

static void read_colour(int i, double albedo[3])
{
    if (i < colours.count && !cli_numbers(colours.text[i], 3, albedo))
        cli_wrong("--mesh-colour \"%s\": expected three numbers R,G,B", colours.text[i]);
    for (int c = 0; c < 3; c++)
        if (!(albedo[c] >= 0 && albedo[c] <= 1))
            cli_wrong("--mesh-colour %s: must be from 0 to 1", colours.text[i]);
}

/* The --mesh files as a scene has them; their names are left to the caller. */
static void add_to_scene(shape_scene *scene, int i)
{
    shape_error error;
    shape_scene_mesh *mesh;
    cli_check(shape_scene_add_mesh(scene, &mesh, &error), &error);
    read_colour(i, mesh->albedo);
}

shape_scene *render_opaque_list(void)
{
    shape_error error;
    shape_scene *list = shape_scene_create(&error);
    if (!list)
        cli_fail("%s", error.text);
    for (int i = 0; i < meshes.count; i++) {
        add_to_scene(list, i);
        cli_check(shape_scene_set_text(&list->meshes[i].file, meshes.text[i], &error), &error);
    }
    return list;
}

/* Appends " --name 'text'", as a shell reads it back; cut at room bytes. */
static void append_quoted(char *text, size_t room, const char *name, const char *value)
{
    size_t used = strlen(text);
    int length = snprintf(text + used, room - used, " --%s '", name);
    used += length > 0 ? (size_t)length : 0;
    for (const char *c = value; *c && used + 8 < room; c++)
        used += (size_t)snprintf(text + used, room - used, *c == '\'' ? "'\\''" : "%c", *c);
    if (used + 2 < room)
        snprintf(text + used, room - used, "'");
}

void render_opaque_text(char *text, size_t room)
{
    text[0] = 0;
    for (int i = 0; i < meshes.count; i++)
        append_quoted(text, room, "mesh", meshes.text[i]);
    for (int i = 0; i < colours.count; i++)
        append_quoted(text, room, "mesh-colour", colours.text[i]);
    size_t used = strlen(text);
    if (ground_given)
        snprintf(text + used, room - used, " --ground %.9g --ground-colour %.9g,%.9g,%.9g", ground,
                 ground_colour[0], ground_colour[1], ground_colour[2]);
}

bool render_opaque_ground(double *height, float albedo[3])
{
    for (int c = 0; c < 3; c++)
        albedo[c] = (float)ground_colour[c];
    *height = ground;
    return ground_given;
}

shape_opaque *render_opaque_read(const cli_input *input)
{
    shape_error error;
    const shape_scene *scene = input->scene;
    bool in_scene = scene && (scene->mesh_count || scene->ground_given);
    if (colours.count > meshes.count)
        cli_wrong("--mesh-colour: there are more colours than meshes");
    if (cli_given("ground-colour") && !ground_given)
        cli_wrong("--ground-colour needs --ground");
    if (!render_opaque_given() && !in_scene)
        return NULL;
    shape_opaque *opaque = shape_opaque_create(&error);
    shape_scene *own = opaque ? shape_scene_create(&error) : NULL;
    if (!own)
        cli_fail("%s", error.text);
    if (in_scene)
        opaque_scene_add(opaque, input->scene, input->path);
    for (int i = 0; i < meshes.count; i++) {
        add_to_scene(own, i);
        opaque_scene_add_file(opaque, &own->meshes[i], meshes.text[i]);
    }
    shape_scene_destroy(own);
    double height;
    float albedo[3];
    bool flat = render_opaque_ground(&height, albedo);
    if (!flat && scene && scene->ground_given) {
        flat = true;
        height = scene->ground;
        for (int c = 0; c < 3; c++)
            albedo[c] = (float)scene->ground_albedo[c];
    }
    if (flat)
        cli_check(shape_opaque_add_ground(opaque, height, albedo, &error), &error);
    cli_check(shape_opaque_finish(opaque, &error), &error);
    return opaque;
}

void render_opaque_save_check(void)
{
    for (int i = 0; i < meshes.count; i++)
        if (!strcmp(meshes.text[i], "-"))
            cli_wrong("--save-scene: a scene cannot name standard input (name the mesh's file)");
}

void render_opaque_save(shape_scene *scene)
{
    for (int i = 0; i < meshes.count; i++) {
        add_to_scene(scene, i);
        scene->meshes[scene->mesh_count - 1].file = cli_save_name(meshes.text[i]);
    }
    if (ground_given) {
        scene->ground_given = true;
        scene->ground = ground;
        memcpy(scene->ground_albedo, ground_colour, sizeof ground_colour);
    }
}
