/* Values of options: strict numbers, and texts into the variables of an option table. */
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "cli_private.h"

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
        if (!cli_number(text, &range[0]))
            return false;
        range[1] = range[0];
        return true;
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
    texts->text[texts->count] = strdup(text); /* the option's own text is gone when it is given again */
    if (!texts->text[texts->count++])
        cli_fail("not enough memory");
}

void cli_store(const cli_option *option, const char *text)
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
