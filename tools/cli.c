/* Options, streams, exit codes. The option table drives popt, the ranges, --help and the provenance line. */
#include "cli.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <popt.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "shape/file.h"
#include "cli_private.h"
#include "shape/neph.h"

enum { MAX_OPTIONS = 160 };

/* One process, one command line: what cli_error, cli_say and cli_made_by need later. */
static const char *program_name = "neph";
static bool be_quiet;
static char made_by_text[4096], inputs_text[2048];

static void print_line(const char *format, va_list arguments)
{
    fprintf(stderr, "%s: ", program_name);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
}

void cli_error(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    print_line(format, arguments);
    va_end(arguments);
}

void cli_fail(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    print_line(format, arguments);
    va_end(arguments);
    exit(CLI_FAILED);
}

void cli_wrong(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    print_line(format, arguments);
    va_end(arguments);
    exit(CLI_WRONG);
}

void cli_check(shape_status status, const shape_error *error)
{
    if (status)
        cli_fail("%s", error->text);
}

void cli_say(const char *format, ...)
{
    if (be_quiet)
        return;
    va_list arguments;
    va_start(arguments, format);
    print_line(format, arguments);
    va_end(arguments);
}

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

void cli_progress(const char *what, double done)
{
    static double start = -1, shown = 0;
    double time = now();
    if (start < 0)
        start = shown = time;
    if (be_quiet || !isatty(STDERR_FILENO))
        return;
    if (done >= 1) {
        if (shown > start)
            fprintf(stderr, "\r\033[K");
        start = -1;
    } else if (time - start > 1 && time - shown > 0.1 && done > 0) {
        fprintf(stderr, "\r%s: %s %.0f %% (%.0f s left)\033[K", program_name, what, 100 * done,
                (time - start) * (1 - done) / done);
        fflush(stderr);
        shown = time;
    }
}

bool cli_number(const char *text, double *value)
{
    /* strtod reads more than a person would call a number: blanks, "inf", "nan", hexadecimal. */
    for (const char *c = text; *c; c++)
        if (!strchr("0123456789+-.eE", *c))
            return false;
    char *end;
    errno = 0;
    double number = strtod(text, &end);
    if (end == text || *end || !isfinite(number))
        return false;
    *value = number;
    return true;
}

bool cli_numbers(const char *text, int count, double *values)
{
    char part[128];
    for (int i = 0; i < count; i++) {
        size_t length = strcspn(text, ",");
        if (length >= sizeof part || (text[length] == ',') != (i + 1 < count))
            return false;
        memcpy(part, text, length);
        part[length] = 0;
        if (!cli_number(part, &values[i]))
            return false;
        text += length + 1;
    }
    return true;
}

static bool parse_integer(const char *text, int64_t *value)
{
    const char *digits = text + (*text == '-' || *text == '+');
    if (!isdigit((unsigned char)*digits) || digits[strspn(digits, "0123456789")])
        return false;
    errno = 0;
    long long number = strtoll(text, NULL, 10);
    *value = number;
    return !errno;
}

static bool parse_range(const char *text, double range[2])
{
    const char *dots = strstr(text, "..");
    if (!dots) {
        bool good = cli_number(text, &range[0]);
        range[1] = range[0];
        return good;
    }
    char low[128];
    size_t length = (size_t)(dots - text);
    if (length >= sizeof low)
        return false;
    memcpy(low, text, length);
    low[length] = 0;
    return cli_number(low, &range[0]) && cli_number(dots + 2, &range[1]);
}

static bool parse_size(const char *text, int64_t size[2])
{
    char width[32];
    size_t length = strcspn(text, "x");
    if (text[length] != 'x' || length >= sizeof width)
        return false;
    memcpy(width, text, length);
    width[length] = 0;
    return parse_integer(width, &size[0]) && parse_integer(text + length + 1, &size[1]);
}

static bool parse_choice(const char *text, const char *choices, int *place)
{
    size_t length = strlen(text);
    int index = 0;
    for (const char *word = choices;; index++) {
        size_t size = strcspn(word, "|");
        if (size == length && !memcmp(word, text, size)) {
            *place = index;
            return true;
        }
        if (!word[size])
            return false;
        word += size + 1;
    }
}

static const char *kind_name(const cli_option *option)
{
    switch (option->kind) {
    case CLI_FLAG:
    case CLI_TEXT:
    case CLI_TEXTS:
        break;
    case CLI_NUMBER:
        return "a number";
    case CLI_INTEGER:
        return "a whole number";
    case CLI_SEED:
        return "a whole number from 0 to 18446744073709551615";
    case CLI_VECTOR:
        return "three numbers X,Y,Z";
    case CLI_PAIR:
        return "two numbers X,Y";
    case CLI_RANGE:
        return "a number or a range A..B";
    case CLI_SIZE:
        return "a size WIDTHxHEIGHT";
    case CLI_CHOICE:
        return option->choices;
    }
    return "a text";
}

static void check_values(const cli_option *option, const char *text, const double *values, int count)
{
    if (option->min == 0 && option->max == 0)
        return;
    for (int i = 0; i < count; i++)
        if (!(values[i] >= option->min && values[i] <= option->max))
            cli_wrong("--%s %s: must be from %.9g to %.9g", option->name, text, option->min, option->max);
}

static void add_text(const cli_option *option, const char *text)
{
    cli_texts *texts = option->value;
    if (texts->count == CLI_TEXTS_MAX)
        cli_wrong("--%s: given more than %d times", option->name, (int)CLI_TEXTS_MAX);
    texts->text[texts->count] = strdup(text);
    if (!texts->text[texts->count++])
        cli_fail("not enough memory");
}

static void store(const cli_option *option, const char *text)
{
    double values[3];
    int64_t *integers = option->value;
    int count = option->kind == CLI_VECTOR ? 3 : option->kind == CLI_NUMBER ? 1 : 2;
    bool good = true;
    switch (option->kind) {
    case CLI_FLAG:
        *(bool *)option->value = true;
        break;
    case CLI_TEXT:
        *(const char **)option->value = text;
        break;
    case CLI_TEXTS:
        add_text(option, text);
        break;
    case CLI_CHOICE:
        good = parse_choice(text, option->choices, option->value);
        break;
    case CLI_SEED:
        good = isdigit((unsigned char)*text) && !text[strspn(text, "0123456789")];
        errno = 0;
        *(uint64_t *)option->value = strtoull(text, NULL, 10);
        good = good && !errno;
        break;
    case CLI_INTEGER:
    case CLI_SIZE:
        count = option->kind == CLI_SIZE ? 2 : 1;
        good = count == 2 ? parse_size(text, integers) : parse_integer(text, integers);
        for (int i = 0; i < count && good; i++)
            values[i] = (double)integers[i];
        if (good)
            check_values(option, text, values, count);
        break;
    case CLI_NUMBER:
    case CLI_VECTOR:
    case CLI_PAIR:
    case CLI_RANGE:
        good = option->kind == CLI_RANGE ? parse_range(text, values) : cli_numbers(text, count, values);
        if (good) {
            check_values(option, text, values, count);
            memcpy(option->value, values, (size_t)count * sizeof *values);
        }
        if (good && option->kind == CLI_RANGE && values[0] > values[1])
            cli_wrong("--%s %s: the range runs backwards (write the smaller number first)", option->name,
                      text);
        break;
    }
    if (!good)
        cli_wrong("--%s \"%s\": expected %s", option->name, text, kind_name(option));
    if (option->given)
        *option->given = true;
}

/* Adds " text" to a line that is cut with " ..." rather than overrun. */
static void append(char *line, size_t room, const char *text)
{
    size_t used = strlen(line);
    if (used + strlen(text) + 2 <= room)
        snprintf(line + used, room - used, " %s", text);
}

void cli_append_input(const char *word)
{
    append(inputs_text, sizeof inputs_text, word);
}

static void record(const cli_option *option, const char *text)
{
    if (option->unrecorded)
        return;
    char word[512];
    snprintf(word, sizeof word, "--%s%s%s", option->name, text ? " " : "", text ? text : "");
    append(made_by_text, sizeof made_by_text, word);
}

static const char *argument_name(const cli_option *option)
{
    static const char *const names[] = {NULL,     "X",   "N",  "N",    "X,Y,Z", "X,Y",
                                        "A|A..B", "WxH", NULL, "TEXT", "TEXT"};
    return option->choices ? option->choices : names[option->kind];
}

static void print_help(const cli_program *program)
{
    printf("Usage: %s [OPTION]... %s\n\n%s\n", program->name, program->arguments, program->about);
    for (const cli_group *group = program->groups; group->title; group++) {
        printf("\n%s:\n", group->title);
        for (const cli_option *option = group->options; option->name; option++) {
            char left[160], letter[6] = "";
            const char *argument = option->kind == CLI_FLAG ? NULL : argument_name(option);
            if (option->letter)
                snprintf(letter, sizeof letter, "-%c, ", option->letter);
            snprintf(left, sizeof left, "  %s--%s%s%s", letter, option->name, argument ? " " : "",
                     argument ? argument : "");
            if (strlen(left) > 30)
                printf("%s\n%32s%s\n", left, "", option->help);
            else
                printf("%-32s%s\n", left, option->help);
        }
    }
    if (program->examples)
        printf("\nExamples:\n%s", program->examples);
    printf("\nExit status: 0 done; 1 the work failed; 2 the command was wrong.\n");
}

static bool show_help, show_version;

static int collect(const cli_program *program, const cli_group *own, const cli_option **all)
{
    int count = 0;
    const cli_group *sources[] = {program->groups, own};
    for (int s = 0; s < 2; s++)
        for (const cli_group *group = sources[s]; group->title; group++)
            for (const cli_option *option = group->options; option->name && count < MAX_OPTIONS; option++)
                all[count++] = option;
    return count;
}

void cli_parse(const cli_program *program, int argc, char **argv, cli_common *common)
{
    program_name = program->name;
    signal(SIGPIPE, SIG_IGN); /* a closed pipe is an error of write(), reported like another */
    cli_common start = {.output = "-", .seed = 1};
    *common = start;
    const cli_option common_options[] = {
        {"output", 'o', CLI_TEXT, &common->output, 0, 0, "FILE", "where to write [-, standard output]",
         &common->output_given, true},
        {"seed", 0, CLI_SEED, &common->seed, 0, 0, "N",
         "64-bit seed of everything that is drawn by chance [1]", &common->seed_given, false},
        {"quiet", 'q', CLI_FLAG, &common->quiet, 0, 0, NULL, "no progress, no summary", NULL, true},
        {"help", 0, CLI_FLAG, &show_help, 0, 0, NULL, "this text", NULL, true},
        {"version", 0, CLI_FLAG, &show_version, 0, 0, NULL, "the version", NULL, true},
        {0}};
    const cli_group common_groups[] = {{"Common", common_options}, {0}};
    const cli_option *all[MAX_OPTIONS];
    int count = collect(program, common_groups, all);
    struct poptOption table[MAX_OPTIONS + 1];
    memset(table, 0, sizeof table);
    for (int i = 0; i < count; i++) {
        table[i].longName = all[i]->name;
        table[i].shortName = all[i]->letter;
        table[i].argInfo = all[i]->kind == CLI_FLAG ? POPT_ARG_NONE : POPT_ARG_STRING;
        table[i].val = i + 1;
    }
    snprintf(made_by_text, sizeof made_by_text, "%s %s", program->name, shape_version());
    poptContext context = poptGetContext(program->name, argc, (const char **)argv, table, 0);
    int code;
    while ((code = poptGetNextOpt(context)) > 0) {
        static char *kept[MAX_OPTIONS]; /* for the program's life: CLI_TEXT points into it */
        char *text = poptGetOptArg(context);
        store(all[code - 1], text ? text : "");
        record(all[code - 1], text);
        free(kept[code - 1]);
        kept[code - 1] = text;
    }
    if (code < -1)
        cli_wrong("%s: %s (see --help)", poptBadOption(context, POPT_BADOPTION_NOALIAS), poptStrerror(code));
    be_quiet = common->quiet;
    if (show_help) {
        cli_group groups[16];
        int used = 0;
        for (const cli_group *group = program->groups; group->title && used < 14; group++)
            groups[used++] = *group;
        groups[used++] = common_groups[0];
        memset(&groups[used], 0, sizeof groups[used]);
        cli_program whole = *program;
        whole.groups = groups;
        print_help(&whole);
        exit(fflush(stdout) ? CLI_FAILED : CLI_DONE);
    }
    if (show_version) {
        printf("%s %s\n", program->name, shape_version());
        exit(fflush(stdout) ? CLI_FAILED : CLI_DONE);
    }
    const char **rest = poptGetArgs(context);
    while (rest && rest[common->argument_count])
        common->argument_count++;
    common->arguments = calloc((size_t)common->argument_count + 1, sizeof *common->arguments);
    if (!common->arguments)
        cli_fail("not enough memory");
    for (int i = 0; i < common->argument_count; i++) {
        common->arguments[i] = strdup(rest[i]);
        if (!common->arguments[i])
            cli_fail("not enough memory");
    }
    poptFreeContext(context);
    if (common->argument_count < program->min_arguments)
        cli_wrong("%s is missing (see --help)", program->arguments);
    if (common->argument_count > program->max_arguments)
        cli_wrong("\"%s\" is one argument too many (see --help)", common->arguments[program->max_arguments]);
}

void cli_made_by(char made_by[SHAPE_MADE_BY_MAX + 1])
{
    char whole[sizeof made_by_text + sizeof inputs_text];
    snprintf(whole, sizeof whole, "%s%s", made_by_text, inputs_text);
    size_t length = strlen(whole);
    if (length > SHAPE_MADE_BY_MAX) {
        length = SHAPE_MADE_BY_MAX - 4;
        while (length && ((unsigned char)whole[length] & 0xc0) == 0x80)
            length--;
        snprintf(whole + length, sizeof whole - length, " ...");
    }
    cli_clean_text(whole);
    memcpy(made_by, whole, strlen(whole) + 1);
}

int cli_finish(cli_common *common)
{
    for (int i = 0; i < common->argument_count; i++)
        free((void *)common->arguments[i]);
    free(common->arguments);
    if (fflush(stdout) || ferror(stdout)) {
        cli_error("standard output: cannot write: %s", strerror(errno));
        return CLI_FAILED;
    }
    return CLI_DONE;
}

void cli_bare_name(const char *path, const char *otherwise, char name[SHAPE_NAME_MAX + 1])
{
    const char *slash = strrchr(path, '/');
    const char *base = slash ? slash + 1 : path;
    const char *dot = strrchr(base, '.');
    size_t length = dot && dot != base ? (size_t)(dot - base) : strlen(base);
    if (!strcmp(path, "-") || !length) {
        base = otherwise;
        length = strlen(otherwise);
    }
    if (length > SHAPE_NAME_MAX)
        length = SHAPE_NAME_MAX;
    while (length && length < strlen(base) && ((unsigned char)base[length] & 0xc0) == 0x80)
        length--;
    memcpy(name, base, length);
    name[length] = 0;
    cli_clean_text(name);
}
