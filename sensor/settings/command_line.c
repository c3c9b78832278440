/* sensor/settings/command_line.c: one option of a command line, or an error message. */
#include "sensor/settings/command_line.h"

#include "pitviper.h"

#include <stdarg.h>

int command_line_wrong(const char *command, const char *format, ...)
{
    char    text[768];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    const size_t length = strlen(text);
    log_error("%s: %s%s see `pitviper %s --help`", command, text, length && text[length - 1] == '?' ? "" : ";",
              command);
    return 2;
}

/* Returns the number of options with this prefix, and 1 for an exact match. */
static int matches(const struct option **found, const struct option *list, const char *name, size_t length)
{
    int count = 0;
    for (const struct option *o = list; o->name; o++) {
        if (strncmp(o->name, name, length) != 0) continue;
        *found = o;
        if (!o->name[length]) return 1;
        count++;
    }
    return count;
}

static void say_long(const char *command, const char *typed, const struct option *list)
{
    const struct option *found = NULL;
    const int length = (int)strcspn(typed, "="), count = matches(&found, list, typed + 2, (size_t)length - 2);
    char      text[512] = "";
    int       n = 0;
    if (count == 1) {
        command_line_wrong(command, found->has_arg ? "option --%s needs an argument" : "option --%s takes no argument",
                           found->name);
        return;
    }
    if (count > 1) {
        for (const struct option *o = list; o->name && n < (int)sizeof text - 40; o++)
            if (strncmp(o->name, typed + 2, (size_t)length - 2) == 0)
                n += snprintf(text + n, sizeof text - (size_t)n, "%s--%s", n ? ", " : "", o->name);
        command_line_wrong(command, "option %.*s is ambiguous: %s", length, typed, text);
        return;
    }
    snprintf(text, sizeof text, "%.*s", length, typed);
    WordMeant meant = word_meant(text);
    for (const struct option *o = list; o->name; o++) {
        char known[64];
        snprintf(known, sizeof known, "--%s", o->name);
        word_consider(&meant, known);
    }
    command_line_wrong(command, "no such option: %s%s", text, word_hint(&meant));
}

/* cluster: the word that the letter is in; `-size 3` is taken for letters. */
static void say_short(const char *command, int letter, const char *cluster, const char *letters,
                      const struct option *list)
{
    if (letter != ':' && strchr(letters, letter)) {
        command_line_wrong(command, "option -%c needs an argument", letter);
        return;
    }
    for (const struct option *o = list; o->name; o++)
        if (*cluster && strcmp(cluster + 1, o->name) == 0) {
            command_line_wrong(command, "no such option: %s; did you mean --%s?", cluster, o->name);
            return;
        }
    command_line_wrong(command, "no such option: -%c", letter);
}

/* After getopt_long: optopt is 0 for an unknown long option, its value for a known one that is used wrongly. */
static void say_wrong(const char *command, int argc, char **argv, const char *letters, const struct option *list)
{
    const char *before = argv[optind > 0 ? optind - 1 : 0];
    bool        is_long = optopt == 0;
    for (const struct option *o = list; o->name && !is_long; o++)
        is_long = o->val == optopt && strncmp(before, "--", 2) == 0;
    if (is_long) {
        say_long(command, before, list);
        return;
    }
    const bool done = before[0] == '-' && before[1] != '-' && strchr(before, optopt);
    say_short(command, optopt, done ? before : optind < argc ? argv[optind] : "", letters, list);
}

/* `replay` of `pitviper replay`. */
static const char *command_of(const char *called)
{
    static const char program[] = "pitviper ";
    return strncmp(called, program, sizeof program - 1) == 0 ? called + sizeof program - 1 : called;
}

int command_line_option(int argc, char **argv, const char *letters, const struct option *list)
{
    char all[64];
    snprintf(all, sizeof all, "%s%s", letters, strchr(letters, 'h') ? "" : "h");
    opterr = 0;
    const int option = getopt_long(argc, argv, all, list, NULL);
    if (option == 'h' && !strchr(letters, 'h'))
        for (const struct option *o = list; o->name; o++)
            if (strcmp(o->name, "help") == 0) return o->val;
    if (option == '?') say_wrong(command_of(argv[0]), argc, argv, all, list);
    return option;
}

bool command_line_threads(int *threads, const char *command, const char *text)
{
    long long number;
    if (text_to_long(&number, text) && number >= 1 && number <= 256) {
        *threads = (int)number;
        return true;
    }
    command_line_wrong(command, "--threads: '%s' is not a whole number in 1 .. 256", text);
    return false;
}
