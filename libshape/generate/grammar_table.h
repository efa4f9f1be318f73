/* Private to generate/grammar*.c: the table of a grammar's settings, by which they are read and known in the text. */
#ifndef SHAPE_GENERATE_GRAMMAR_TABLE_H
#define SHAPE_GENERATE_GRAMMAR_TABLE_H

#include <stddef.h>

typedef enum setting_kind {
    SETTING_AXIOM,
    SETTING_PUFFS,
    SETTING_RANGE,  /* shape_grammar_range */
    SETTING_WHOLE,  /* int */
    SETTING_NUMBER, /* float */
    SETTING_VECTOR, /* double[3] */
    SETTING_CHOICE  /* int-sized enum, by its place in `words` */
} setting_kind;

typedef struct grammar_setting {
    const char *name;
    setting_kind kind;
    size_t offset; /* in shape_grammar_settings */
    double min, max;
    const char *range; /* what is allowed, in words */
    const char *words[6];
} grammar_setting;

/* The setting of a name, or NULL. */
const grammar_setting *grammar_setting_find(const char *name);
/* Its place in the table, below GRAMMAR_SETTINGS_MAX. */
size_t grammar_setting_index(const grammar_setting *setting);
/* All names, and NULL behind them. */
void grammar_setting_names(const char *names[]);

#endif
