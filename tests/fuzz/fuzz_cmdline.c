/* Command lines: the first byte chooses a program, the rest are its arguments, each ended by a zero byte. The program's
 * own main runs, by its own tables, until it would read, make or write something; there the run ends (the build wraps those
 * functions, and exit). What is accepted holds what its table says; what is not ends with 1 or 2 and one line. */
#include <math.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cmdline.h"

#include <popt.h>

#include "cli_private.h"
#include "shape/file.h"

enum { ARGUMENTS = 40, ROWS = 4096, LINE = 16384, END_OF_RUN = 1000 };

typedef int program_main(int argc, char **argv);
static program_main *const programs[] = {
#define PROGRAM(name) name,
    CMDLINE_PROGRAMS
#undef PROGRAM
};
enum { PROGRAMS = sizeof programs / sizeof *programs };

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed);

void __real_exit(int code) __attribute__((noreturn));
void __real_cli_parse(const cli_program *program, int argc, char **argv, cli_common *common);
poptContext __real_poptGetContext(const char *name, int argc, const char **argv,
                                  const struct poptOption *options, unsigned int flags);
poptContext __real_poptFreeContext(poptContext context);

static jmp_buf end;
static bool running;
static cli_common *common_of_run;
static poptContext context_of_run;
static char name_of_run[64];
static FILE *errors;
static char lines[LINE];

static void must(bool truth)
{
    if (!truth)
        abort();
}

/* --- where a run ends --- */

static _Noreturn void end_run(int code)
{
    must(running);
    cli_common *common = common_of_run; /* in main's own frame, which is there still */
    for (int i = 0; common && common->arguments && i < common->argument_count; i++)
        free((void *)common->arguments[i]);
    free(common ? common->arguments : NULL);
    longjmp(end, END_OF_RUN + code);
}

void __wrap_exit(int code) __attribute__((noreturn));
void __wrap_exit(int code)
{
    if (!running)
        __real_exit(code);
    must(code == CLI_DONE || code == CLI_FAILED || code == CLI_WRONG);
    end_run(code);
}

/* In place of a function that works. */
#define GATE(name)                                                                                           \
    void __wrap_##name(void) __attribute__((noreturn));                                                      \
    void __wrap_##name(void)                                                                                 \
    {                                                                                                        \
        end_run(CLI_DONE);                                                                                   \
    }
GATE(shape_file_read)
GATE(shape_file_write)
GATE(shape_set_create)
GATE(shape_scatter)
GATE(shape_vdb_read)
GATE(cli_is_volume)
GATE(cli_volume_input_read)
GATE(cli_generator_spawn)
GATE(view_frames_draw)
GATE(view_window)

poptContext __wrap_poptGetContext(const char *name, int argc, const char **argv,
                                  const struct poptOption *options, unsigned int flags);
poptContext __wrap_poptGetContext(const char *name, int argc, const char **argv,
                                  const struct poptOption *options, unsigned int flags)
{
    context_of_run = __real_poptGetContext(name, argc, argv, options, flags);
    return context_of_run;
}

poptContext __wrap_poptFreeContext(poptContext context);
poptContext __wrap_poptFreeContext(poptContext context)
{
    context_of_run = NULL;
    return __real_poptFreeContext(context);
}

/* --- values of all options, as they stand before a program runs --- */

typedef struct row {
    const cli_option *option;
    unsigned char value[3 * sizeof(double)];
    bool given;
} row;

static row rows[ROWS];
static int row_count;

static size_t size_of(const cli_option *option)
{
    switch (option->kind) {
    case CLI_FLAG:
        return sizeof(bool);
    case CLI_NUMBER:
    case CLI_INTEGER:
    case CLI_SEED:
        return 8;
    case CLI_VECTOR:
        return 24;
    case CLI_PAIR:
    case CLI_RANGE:
    case CLI_SIZE:
        return 16;
    case CLI_CHOICE:
        return sizeof(int);
    case CLI_TEXT:
        return sizeof(const char *);
    case CLI_TEXTS:
        break;
    }
    return 0;
}

/* Whether a table has been seen; it is from now on. */
static bool know_table(const cli_option *table)
{
    static const cli_option *known[256];
    static int count;
    for (int i = 0; i < count; i++)
        if (known[i] == table)
            return true;
    must(count < 256);
    known[count++] = table;
    return false;
}

/* An option seen for the first time has its default. */
static void note_defaults(const cli_program *program)
{
    for (const cli_group *group = program->groups; group->title; group++)
        for (const cli_option *o = know_table(group->options) ? NULL : group->options; o && o->name; o++) {
            must(row_count < ROWS);
            row *r = &rows[row_count++];
            r->option = o;
            memcpy(r->value, o->value, size_of(o));
            r->given = o->given && *o->given;
        }
}

static void restore(void)
{
    for (int i = 0; i < row_count; i++) {
        const cli_option *option = rows[i].option;
        if (option->kind == CLI_TEXTS) {
            cli_texts *texts = option->value;
            while (texts->count)
                free((void *)texts->text[--texts->count]);
        }
        memcpy(option->value, rows[i].value, size_of(option));
        if (option->given)
            *option->given = rows[i].given;
    }
}

/* --- what was accepted --- */

static void check_numbers(const cli_option *option, const double *values, int count)
{
    for (int i = 0; i < count; i++) {
        must(isfinite(values[i]));
        must((option->min == 0 && option->max == 0) ||
             (values[i] >= option->min && values[i] <= option->max));
    }
    must(option->kind != CLI_RANGE || values[0] <= values[1]);
}

static void check_value(const cli_option *option)
{
    double values[3];
    int count = 0, bars = 0;
    switch (option->kind) {
    case CLI_FLAG:
        must(*(const bool *)option->value);
        break;
    case CLI_SEED:
        break;
    case CLI_TEXT:
        must(*(const char *const *)option->value != NULL);
        break;
    case CLI_TEXTS:
        must(((const cli_texts *)option->value)->count <= CLI_TEXTS_MAX);
        break;
    case CLI_CHOICE:
        for (const char *c = option->choices; *c; c++)
            bars += *c == '|';
        must(*(const int *)option->value >= 0 && *(const int *)option->value <= bars);
        break;
    case CLI_INTEGER:
    case CLI_SIZE:
        count = option->kind == CLI_SIZE ? 2 : 1;
        for (int i = 0; i < count; i++)
            values[i] = (double)((const int64_t *)option->value)[i];
        check_numbers(option, values, count);
        break;
    case CLI_NUMBER:
    case CLI_VECTOR:
    case CLI_PAIR:
    case CLI_RANGE:
        count = (int)(size_of(option) / sizeof(double));
        check_numbers(option, option->value, count);
        break;
    }
    must(!option->given || *option->given);
}

static void check_accepted(const cli_program *program, const cli_common *common)
{
    must(common->argument_count >= program->min_arguments &&
         common->argument_count <= program->max_arguments);
    for (int i = 0; i < common->argument_count; i++)
        must(common->arguments[i] != NULL);
    for (const cli_group *group = program->groups; group->title; group++)
        for (const cli_option *option = group->options; option->name; option++)
            if (cli_given(option->name))
                check_value(option);
    char made_by[SHAPE_MADE_BY_MAX + 1], given[256];
    cli_made_by(made_by);
    must(strlen(made_by) <= SHAPE_MADE_BY_MAX && !strpbrk(made_by, "\n\r\033"));
    for (const cli_group *group = program->groups; group->title; group++) {
        given[0] = 0;
        cli_given_text(group->options, given, sizeof given);
        must(strlen(given) < sizeof given);
    }
}

void __wrap_cli_parse(const cli_program *program, int argc, char **argv, cli_common *common);
void __wrap_cli_parse(const cli_program *program, int argc, char **argv, cli_common *common)
{
    note_defaults(program);
    snprintf(name_of_run, sizeof name_of_run, "%s: ", program->name);
    common_of_run = common;
    __real_cli_parse(program, argc, argv, common);
    check_accepted(program, common);
}

/* --- a run --- */

static void check_errors(int code)
{
    fflush(errors);
    char *line = lines;
    size_t length = strlen(lines), name = strlen(name_of_run);
    if (code == CLI_DONE)
        return; /* notes, maybe */
    must(length && lines[length - 1] == '\n' && !strncmp(line, name_of_run, name));
    must(strchr(line, '\n') == lines + length - 1 && !strpbrk(line, "\r\033"));
    must(length > name + 8);
}

/* The arguments of an input, in place; the last needs no zero. */
static int split(char *text, size_t size, char **arguments)
{
    int count = 0;
    for (size_t at = 0; at < size && count < ARGUMENTS; at += strlen(text + at) + 1)
        arguments[count++] = text + at;
    arguments[count] = NULL;
    return count;
}

static void run(program_main *program, int count, char **arguments)
{
    FILE *real = stderr;
    rewind(errors);
    memset(lines, 0, 64);
    common_of_run = NULL;
    context_of_run = NULL;
    stderr = errors;
    running = true;
    int code = setjmp(end);
    if (!code)
        code = END_OF_RUN + program(count, arguments);
    running = false;
    fputc(0, errors);
    check_errors(code - END_OF_RUN);
    stderr = real;
    cli_set_place("%s", "");
    if (context_of_run)
        poptFreeContext(context_of_run);
    restore();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size < 1)
        return 0;
    static char name[] = "neph";
    char *arguments[ARGUMENTS + 2] = {name}, *text = malloc(size);
    must(text != NULL);
    memcpy(text, data + 1, size - 1);
    text[size - 1] = 0;
    int count = split(text, size - 1, arguments + 1);
    run(programs[data[0] % PROGRAMS], count + 1, arguments);
    free(text);
    return 0;
}

/* Runs each program once, so that all options are known to the mutator. */
int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc;
    (void)argv;
    errors = fmemopen(lines, sizeof lines, "w");
    must(errors && freopen("/dev/null", "w", stdout));
    for (int i = 0; i < PROGRAMS; i++) {
        uint8_t input[] = "?--version";
        input[0] = (uint8_t)i;
        LLVMFuzzerTestOneInput(input, sizeof input);
    }
    return 0;
}

/* --- inputs that come further than bytes at random --- */

static const char *choose_text(const cli_option *option, unsigned draw, char *room, size_t size)
{
    static const char *const texts[] = {"1",   "0",    "0,0,1", "2,3", "1..2",    "64x48", "-1", "1e300",
                                        "nan", "0.25", "a.png", "-",   "1,2,3,4", "9..1",  "",   "a.neph"};
    if (option->kind != CLI_CHOICE || draw % 8 == 0)
        return texts[draw / 8 % (sizeof texts / sizeof *texts)];
    const char *word = option->choices;
    for (unsigned skip = draw / 8 % 4; skip && strchr(word, '|'); skip--)
        word = strchr(word, '|') + 1;
    snprintf(room, size, "%.*s", (int)strcspn(word, "|"), word);
    return room;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed)
{
    char more[256], room[64];
    if (seed % 2 || !row_count)
        return LLVMFuzzerMutate(data, size, max_size);
    const cli_option *option = rows[seed / 2 % (unsigned)row_count].option;
    int length = option->kind == CLI_FLAG ? snprintf(more, sizeof more, "--%s", option->name)
                                          : snprintf(more, sizeof more, "--%s=%s", option->name,
                                                     choose_text(option, seed / 7, room, sizeof room));
    size_t used = (size_t)length + 1;
    if (size < 1 || size + used > max_size || used > sizeof more)
        return LLVMFuzzerMutate(data, size, max_size);
    memmove(data + 1 + used, data + 1, size - 1);
    memcpy(data + 1, more, used);
    return size + used;
}
