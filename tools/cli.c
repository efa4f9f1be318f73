/* A program's command line: the option table drives popt, the ranges, --help and the provenance line. */
#include "cli.h"

#include <errno.h>
#include <fcntl.h>
#include <popt.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli_private.h"

static bool show_help, show_version, generate_given;
static int generate_kind;

static int collect(const cli_program *program, const cli_group *own, const cli_option **all)
{
    int count = 0;
    const cli_group *sources[] = {program->groups, own};
    for (int s = 0; s < 2; s++)
        for (const cli_group *group = sources[s]; group->title; group++)
            for (const cli_option *option = group->options; option->name && count < CLI_MAX_OPTIONS; option++)
                all[count++] = option;
    return count;
}

/* A stream that was closed before we began must not become a file of ours, into which messages would go: it is opened
 * the wrong way round, so that its use is an error as it would have been. */
static void hold_streams(void)
{
    for (int stream = 0; stream <= 2; stream++)
        if (fcntl(stream, F_GETFD) < 0 && open("/dev/null", stream ? O_RDONLY : O_WRONLY) != stream)
            exit(CLI_FAILED);
}

/* The end of what was asked for and needs no work. */
static _Noreturn void end_output(void)
{
    if (fflush(stdout))
        cli_fail("standard output: cannot write: %s", strerror(errno));
    exit(CLI_DONE);
}

/* Whether a command line has anything but options. popt, where it has no memory for that, says that there is nothing. */
static bool has_rest(const char *name, int argc, char **argv, const struct poptOption *table)
{
    poptContext context = poptGetContext(name, argc, (const char **)argv, table, 0);
    if (!context)
        cli_fail("not enough memory");
    while (poptGetNextOpt(context) > 0)
        free(poptGetOptArg(context));
    bool has = poptPeekArg(context);
    poptFreeContext(context);
    return has;
}

void cli_parse(const cli_program *program, int argc, char **argv, cli_common *common)
{
    cli_set_program(program->name);
    hold_streams();
    signal(SIGPIPE, SIG_IGN); /* a closed pipe is an error of write(), reported like another */
    signal(SIGXFSZ, SIG_IGN); /* and so is a file that may not grow further */
    cli_common start = {.output = "-", .seed = 1};
    *common = start;
    const cli_option rows[] = {
        {"output", 'o', CLI_TEXT, &common->output, 0, 0, "FILE", "where to write [-, standard output]",
         &common->output_given, true},
        {"seed", 0, CLI_SEED, &common->seed, 0, 0, "N",
         "64-bit seed of everything that is drawn by chance [1]", &common->seed_given, false},
        {"quiet", 'q', CLI_FLAG, &common->quiet, 0, 0, NULL, "no progress, no summary", NULL, true},
        {"generate", 0, CLI_CHOICE, &generate_kind, 0, 0, "man|bash|zsh",
         "print the manual page, or a shell's completion, and end", &generate_given, true},
        {"help", 0, CLI_FLAG, &show_help, 0, 0, NULL, "this text", NULL, true},
        {"version", 0, CLI_FLAG, &show_version, 0, 0, NULL, "the version", NULL, true},
        {0}};
    static cli_option common_options[sizeof rows / sizeof *rows]; /* the record points into it */
    memcpy(common_options, rows, sizeof rows);
    const cli_group common_groups[] = {{"Common", common_options}, {0}};
    const cli_option *all[CLI_MAX_OPTIONS];
    int count = collect(program, common_groups, all);
    struct poptOption table[CLI_MAX_OPTIONS + 1];
    memset(table, 0, sizeof table);
    for (int i = 0; i < count; i++) {
        table[i].longName = all[i]->name;
        table[i].shortName = all[i]->letter;
        table[i].argInfo = all[i]->kind == CLI_FLAG ? POPT_ARG_NONE : POPT_ARG_STRING;
        table[i].val = i + 1;
    }
    show_help = show_version = generate_given = false;
    cli_record_start(program->name);
    cli_given_start();
    poptContext context = poptGetContext(program->name, argc, (const char **)argv, table, 0);
    if (!context)
        cli_fail("not enough memory");
    int code;
    while ((code = poptGetNextOpt(context)) > 0) {
        static char *kept[CLI_MAX_OPTIONS]; /* for the program's life: CLI_TEXT points into it */
        char *text = poptGetOptArg(context);
        if (!text && all[code - 1]->kind != CLI_FLAG)
            cli_fail("not enough memory");
        free(kept[code - 1]);
        kept[code - 1] = text;
        cli_store(all[code - 1], text ? text : "");
        cli_record_option(all[code - 1], text);
        cli_note_given(all[code - 1], text);
    }
    if (code == POPT_ERROR_MALLOC)
        cli_fail("not enough memory");
    if (code < -1)
        cli_wrong("%s: %s (see --help)", poptBadOption(context, POPT_BADOPTION_NOALIAS), poptStrerror(code));
    cli_set_quiet(common->quiet);
    if (show_help || generate_given) {
        cli_group groups[16];
        int used = 0;
        for (const cli_group *group = program->groups; group->title && used < 14; group++)
            groups[used++] = *group;
        groups[used++] = common_groups[0];
        memset(&groups[used], 0, sizeof groups[used]);
        cli_program whole = *program;
        whole.groups = groups;
        if (show_help)
            cli_print_help(&whole);
        else
            cli_generate(common, &whole, (cli_generate_kind)generate_kind);
        end_output();
    }
    if (show_version) {
        printf("%s %s\n", program->name, shape_version());
        end_output();
    }
    const char **rest = poptGetArgs(context);
    if (!rest && has_rest(program->name, argc, argv, table))
        cli_fail("not enough memory");
    while (rest && rest[common->argument_count])
        common->argument_count++;
    common->arguments = calloc((size_t)common->argument_count + 1, sizeof *common->arguments);
    if (!common->arguments)
        cli_fail("not enough memory");
    for (int i = 0; rest && i < common->argument_count; i++) {
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
