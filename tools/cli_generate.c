/* --generate: the manual page and the shells' completion, from the same tables as --help, so that they cannot differ
 * from the program. Manual pages: man(7). Completion: bash's `complete`, zsh's `_arguments`. */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "cli_private.h"

typedef void option_printer(FILE *out, const cli_option *option);

static void each_option(FILE *out, const cli_program *program, option_printer *print)
{
    for (const cli_group *group = program->groups; group->title; group++)
        for (const cli_option *option = group->options; option->name; option++)
            print(out, option);
}

/* --- the manual page */

/* One character; a line must not begin as a request does, and a hyphen that is typed is no hyphen that is set. */
static void roff_character(FILE *out, char c, bool line_start)
{
    if (c == '\\')
        fputs("\\e", out);
    else if (c == '-')
        fputs("\\-", out);
    else if (line_start && (c == '.' || c == '\''))
        fprintf(out, "\\&%c", c);
    else
        fputc(c, out);
}

static void roff_text(FILE *out, const char *text)
{
    for (const char *c = text; *c; c++)
        roff_character(out, *c, c == text || c[-1] == '\n');
}

static void roff_option(FILE *out, const cli_option *option)
{
    const char *argument = cli_argument_name(option);
    fputs(".TP\n", out);
    if (option->letter)
        fprintf(out, "\\fB\\-%c\\fR, ", option->letter);
    fputs("\\fB\\-\\-", out);
    roff_text(out, option->name);
    fputs("\\fR", out);
    if (argument) {
        fputs(" \\fI", out);
        roff_text(out, argument);
        fputs("\\fR", out);
    }
    fputc('\n', out);
    roff_text(out, option->help);
    fputc('\n', out);
}

/* The first sentence of what the program is, begun in lower case and without its full stop. */
static void roff_summary(FILE *out, const char *about)
{
    for (const char *c = about; *c && !(*c == '.' && (!c[1] || isspace((unsigned char)c[1]))); c++)
        roff_character(out, *c == '\n' ? ' ' : c == about ? (char)tolower((unsigned char)*c) : *c, false);
    fputc('\n', out);
}

/* The examples of --help, without their indentation. */
static void roff_examples(FILE *out, const char *examples)
{
    fputs(".SH EXAMPLES\n.nf\n", out);
    for (const char *line = examples; *line;) {
        line += strspn(line, " ");
        size_t size = strcspn(line, "\n");
        for (size_t i = 0; i < size; i++)
            roff_character(out, line[i], i == 0);
        fputc('\n', out);
        line += size + (line[size] == '\n');
    }
    fputs(".fi\n", out);
}

static void print_manual(FILE *out, const cli_program *program)
{
    fprintf(out, ".\\\" Made by `%s --generate man`.\n.TH \"%s\" 1 \"\" \"Nephele %s\" \"Nephele\"\n",
            program->name, program->name, shape_version());
    fputs(".nh\n.ad l\n.SH NAME\n", out);
    roff_text(out, program->name);
    fputs(" \\- ", out);
    roff_summary(out, program->about);
    fputs(".SH SYNOPSIS\n\\fB", out);
    roff_text(out, program->name);
    fputs("\\fR [\\fIOPTION\\fR]... ", out);
    roff_text(out, program->arguments);
    fputs("\n.SH DESCRIPTION\n", out);
    roff_text(out, program->about);
    fputs("\n.SH OPTIONS\n", out);
    for (const cli_group *group = program->groups; group->title; group++) {
        fputs(".SS ", out);
        roff_text(out, group->title);
        fputc('\n', out);
        for (const cli_option *option = group->options; option->name; option++)
            roff_option(out, option);
    }
    if (program->examples)
        roff_examples(out, program->examples);
    fputs(".SH EXIT STATUS\n.TP\n.B 0\nDone.\n.TP\n.B 1\nThe work failed: a bad input, no memory, no room on "
          "the "
          "disk. One line on standard error says what is wrong and what to do.\n.TP\n.B 2\nThe command was "
          "wrong.\n",
          out);
}

/* --- bash */

static bool takes_file(const cli_option *option)
{
    return option->kind == CLI_TEXT || option->kind == CLI_TEXTS;
}

static void bash_name(FILE *out, const cli_option *option)
{
    if (option->letter)
        fprintf(out, "-%c ", option->letter);
    fprintf(out, "--%s ", option->name);
}

/* A branch of the case over the word before: words to choose from, or nothing where a number is wanted. */
static void bash_branch(FILE *out, const cli_option *option)
{
    if (option->kind == CLI_FLAG || takes_file(option))
        return;
    fputs("    ", out);
    if (option->letter)
        fprintf(out, "-%c | ", option->letter);
    fprintf(out, "--%s) words='", option->name);
    for (const char *c = option->kind == CLI_CHOICE ? option->choices : ""; *c; c++)
        fputc(*c == '|' ? ' ' : *c, out);
    fputs("' ;;\n", out);
}

static void shell_function(FILE *out, const char *name)
{
    for (const char *c = name; *c; c++)
        fputc(*c == '-' ? '_' : *c, out);
}

static void print_bash(FILE *out, const cli_program *program)
{
    fprintf(out, "# bash completion of %s. Made by `%s --generate bash`.\n_", program->name, program->name);
    shell_function(out, program->name);
    /* bash splits --option=word at the equals sign. */
    fputs("()\n{\n"
          "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} words\n"
          "    if [[ $word == '=' ]]; then\n"
          "        word=\n"
          "    elif [[ $before == '=' ]]; then\n"
          "        before=${COMP_WORDS[COMP_CWORD - 2]}\n"
          "    fi\n"
          "    case $before in\n",
          out);
    each_option(out, program, bash_branch);
    fputs("    *)\n"
          "        if [[ $word != -* ]]; then\n"
          "            mapfile -t COMPREPLY < <(compgen -f -- \"$word\")\n"
          "            return\n"
          "        fi\n"
          "        words='",
          out);
    each_option(out, program, bash_name);
    fputs("'\n        ;;\n    esac\n"
          "    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n}\ncomplete -o filenames -F _",
          out);
    shell_function(out, program->name);
    fprintf(out, " %s\n", program->name);
}

/* --- zsh */

/* Text within single quotes and within the brackets of an option's description. */
static void zsh_text(FILE *out, const char *text)
{
    for (const char *c = text; *c; c++) {
        if (*c == '\'')
            fputs("'\\''", out);
        else if (strchr("[]:\\", *c))
            fprintf(out, "\\%c", *c);
        else
            fputc(*c, out);
    }
}

static void zsh_option(FILE *out, const cli_option *option)
{
    const char *argument = cli_argument_name(option);
    const char *more = argument ? "=" : "";
    if (option->letter)
        fprintf(out, "  '(-%c --%s)'{-%c%s,--%s%s}'[", option->letter, option->name, option->letter,
                argument ? "+" : "", option->name, more);
    else
        fprintf(out, "  '--%s%s[", option->name, more);
    zsh_text(out, option->help);
    fputc(']', out);
    if (argument) {
        fputc(':', out);
        zsh_text(out, option->kind == CLI_CHOICE ? option->name : argument);
        fputs(takes_file(option) ? ":_files" : ":", out);
        if (option->kind == CLI_CHOICE) {
            fputc('(', out);
            for (const char *c = option->choices; *c; c++)
                fputc(*c == '|' ? ' ' : *c, out);
            fputc(')', out);
        }
    }
    fputs("' \\\n", out);
}

static void print_zsh(FILE *out, const cli_program *program)
{
    fprintf(out, "#compdef %s\n# Made by `%s --generate zsh`.\n_arguments -s -S \\\n", program->name,
            program->name);
    each_option(out, program, zsh_option);
    fputs(program->max_arguments ? "  '*:file:_files'\n" : "  && return 0\n", out);
}

void cli_generate(const cli_common *common, const cli_program *program, cli_generate_kind kind)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        cli_fail("not enough memory");
    if (kind == CLI_GENERATE_MAN)
        print_manual(out, program);
    else if (kind == CLI_GENERATE_BASH)
        print_bash(out, program);
    else
        print_zsh(out, program);
    if (fclose(out))
        cli_fail("not enough memory");
    cli_write(common, text, size, false);
    free(text);
}
