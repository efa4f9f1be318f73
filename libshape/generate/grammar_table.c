/* The settings that a grammar knows: names, kinds, places and ranges. */
#include "generate/grammar_table.h"

#include <string.h>

#include "generate/grammar_private.h"

#define AT(member) offsetof(shape_grammar_settings, member)
static const grammar_setting settings[] = {
    {"axiom", SETTING_AXIOM, 0, 0, 0, NULL, {NULL}},
    {"puffs", SETTING_PUFFS, 0, 0, 0, NULL, {NULL}},
    {"iterations",
     SETTING_WHOLE,
     AT(iterations),
     0,
     SHAPE_GRAMMAR_ITERATIONS_MAX,
     "a whole number, 0 to 100000",
     {NULL}},
    {"angle", SETTING_RANGE, AT(angle), -1e6, 1e6, "degrees, -1e6 to 1e6", {NULL}},
    {"radius", SETTING_RANGE, AT(radius), 1e-9, 1e9, "metres, above 0, at most 1e9", {NULL}},
    {"length", SETTING_RANGE, AT(length), 0, 1e9, "metres, 0 to 1e9", {NULL}},
    {"shrink", SETTING_RANGE, AT(shrink), 1e-9, 1000, "a factor above 0, at most 1000", {NULL}},
    {"stretch", SETTING_VECTOR, AT(stretch), 1e-6, 1e6, "three factors X,Y,Z, each 1e-6 to 1e6", {NULL}},
    {"model", SETTING_CHOICE, AT(field.model), 0, 0, NULL, {"uniform", "spheroid", "metaball", NULL}},
    {"kappa", SETTING_NUMBER, AT(field.kappa), 0, 1, "0 to 1", {NULL}},
    {"octaves", SETTING_WHOLE, AT(field.octaves), 1, 16, "a whole number, 1 to 16", {NULL}},
    {"noise-scale", SETTING_NUMBER, AT(field.noise_scale), 1e-9, 1e9, "metres, above 0, at most 1e9", {NULL}},
    {"edge", SETTING_NUMBER, AT(field.edge), 0, 1e9, "0 to 1e9", {NULL}},
    {"smoothness", SETTING_NUMBER, AT(field.detail.smoothness), 0, 1, "0 to 1", {NULL}},
    {"displace", SETTING_NUMBER, AT(field.detail.displace), 0, 1e9, "metres, 0 to 1e9", {NULL}},
    {"displace-scale", SETTING_NUMBER, AT(field.detail.displace_scale), 0, 1e9, "metres, 0 to 1e9", {NULL}},
    {"billow", SETTING_NUMBER, AT(field.detail.billow), 0, 1, "0 to 1", {NULL}},
    {"wisp", SETTING_NUMBER, AT(field.detail.wisp), 0, 1, "0 to 1", {NULL}},
    {"detail-depth", SETTING_NUMBER, AT(field.detail.detail_depth), 0, 1, "0 to 1", {NULL}},
    {"detail-scale", SETTING_NUMBER, AT(field.detail.detail_scale), 0, 1e9, "metres, 0 to 1e9", {NULL}},
    {"extinction", SETTING_NUMBER, AT(medium.extinction), 0, 1e9, "1/m, 0 to 1e9", {NULL}},
    {"albedo", SETTING_NUMBER, AT(medium.albedo), 0, 1, "0 to 1", {NULL}},
    {"phase",
     SETTING_CHOICE,
     AT(medium.phase),
     0,
     0,
     NULL,
     {"hg", "isotropic", "rayleigh", "mie", "two-lobe", NULL}},
    {"g", SETTING_NUMBER, AT(medium.g), -0.9999, 0.9999, "-0.9999 to 0.9999", {NULL}},
    {"g2", SETTING_NUMBER, AT(medium.g2), -0.9999, 0.9999, "-0.9999 to 0.9999", {NULL}},
    {"lobe-mix", SETTING_NUMBER, AT(medium.lobe_mix), 0, 1, "0 to 1", {NULL}},
    {"droplet", SETTING_NUMBER, AT(medium.droplet), 5, 50, "micrometres, 5 to 50", {NULL}},
};
#undef AT
enum { SETTING_COUNT = sizeof settings / sizeof *settings };
_Static_assert(sizeof(shape_model) == sizeof(int) && sizeof(shape_phase_kind) == sizeof(int),
               "choices are ints");
_Static_assert((int)SETTING_COUNT <= (int)GRAMMAR_SETTINGS_MAX, "make room for the settings' places");

const grammar_setting *grammar_setting_find(const char *name)
{
    for (int i = 0; i < SETTING_COUNT; i++)
        if (!strcmp(settings[i].name, name))
            return &settings[i];
    return NULL;
}

size_t grammar_setting_index(const grammar_setting *setting)
{
    return (size_t)(setting - settings);
}

void grammar_setting_names(const char *names[])
{
    for (int i = 0; i < SETTING_COUNT; i++)
        names[i] = settings[i].name;
    names[SETTING_COUNT] = NULL;
}

bool grammar_at_setting(const parser *p)
{
    char word[NAME_ROOM];
    parser look = *p;
    uint32_t before = p->next ? p->cells[p->next - 1].c : ' ';
    if ((before != ' ' && before != '\t') || !grammar_word(&look, true, word) || !word[1] ||
        !grammar_setting_find(word))
        return false;
    uint32_t behind = grammar_peek(&look, 0);
    return behind == 0 || behind == ' ' || behind == '\t';
}
