/* neph-lsys: a grammar file to a cloud of spheres and ellipsoids (Jiménez 2018, section 3.6.2). */
#include <stdio.h>
#include <string.h>

#include "cli_lsys.h"

static bool print, count;

static const cli_option show_options[] = {
    {"print", 0, CLI_FLAG, &print, 0, 0, NULL,
     "the derived string on standard output; the cloud only by -o FILE", NULL, true},
    {"count", 0, CLI_FLAG, &count, 0, 0, NULL,
     "JSON {\"symbols\", \"primitives\"} on standard output, likewise", NULL, true},
    {0}};

static const cli_program program = {
    .name = "neph-lsys",
    .arguments = "GRAMMAR",
    .about =
        "Makes a cloud from an L-system grammar, and writes it as .neph. The grammar file is described in\n"
        "docs/grammar.md; - reads it from standard input.",
    .examples = "  neph-lsys castellanus.lsys -o castellanus.neph\n"
                "  neph-lsys spiral.lsys --angle 50..100 --seed 7 | neph-view -\n"
                "  neph-lsys spiral.lsys --iterations 3 --print\n",
    .min_arguments = 1,
    .max_arguments = 1};

static shape_status print_symbol(void *user, const shape_symbol *symbol, shape_error *error)
{
    putc(symbol->letter, stdout);
    for (int i = 0; i < symbol->argument_count; i++)
        printf("%c%.9g", i ? ',' : '(', symbol->arguments[i]);
    if (symbol->argument_count)
        putc(')', stdout);
    (void)user;
    /* A reader that has gone must not keep a long derivation alive. */
    return ferror(stdout) ? shape_error_set(error, SHAPE_ERROR_IO, "standard output: cannot write")
                          : SHAPE_OK;
}

/* The string or the counts, on standard output, without a cloud. */
static void show(const shape_grammar *grammar, const shape_derive_options *options)
{
    shape_error error;
    shape_derive_counts counts;
    cli_check(shape_grammar_derive(grammar, options, print ? print_symbol : NULL, NULL, &counts, &error),
              &error);
    if (print)
        printf("\n");
    else
        printf("{\"symbols\": %llu, \"primitives\": %llu}\n", (unsigned long long)counts.symbols,
               (unsigned long long)counts.primitives);
}

int main(int argc, char **argv)
{
    cli_common common;
    cli_generator_parse(&program, &cli_lsys, show_options, argc, argv, &common);
    bool shows = print || count, to_file = strcmp(common.output, "-") != 0;
    if (print && count)
        cli_wrong("--print and --count both write to standard output (give one of them)");
    const char *path = common.arguments[0];
    shape_grammar *grammar = cli_lsys_read(path);
    shape_derive_options options = cli_lsys_options(grammar, common.seed);
    if (shows)
        show(grammar, &options);
    if (!shows || to_file) {
        shape_set *set = cli_lsys_make(grammar, &options, path);
        cli_write_set(&common, set);
        shape_set_destroy(set);
    }
    shape_grammar_destroy(grammar);
    cli_generator_save(&cli_lsys, &common);
    return cli_finish(&common);
}
