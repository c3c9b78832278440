/* sensor/settings/next_option.c: one option of a command line, or an error message. */
#include "sensor/settings/next_option.h"

#include "pitviper.h"

/* Number of options with this prefix; 1 for an exact match. */
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

static void print_error(const char *command, const char *typed, const char *letters, const struct option *list)
{
    const struct option *found = NULL;
    if (strncmp(typed, "--", 2) != 0) {
        if (optopt == ':' || !strchr(letters, optopt)) text_print(stderr, "%s: invalid option -- "
                                                            "'%c'\n", command, optopt);
        else text_print(stderr, "%s: option requires an argument -- '%c'\n", command, optopt);
        return;
    }
    const int length = (int)strcspn(typed, "="), count = matches(&found, list, typed + 2, (size_t)length - 2);
    if (count == 0) text_print(stderr, "%s: unrecognized option '%s'\n", command, typed);
    else if (count > 1) text_print(stderr, "%s: option '%.*s' is ambiguous\n", command, length, typed);
    else if (found->has_arg) text_print(stderr, "%s: option '--%s' requires an argument\n", command, found->name);
    else text_print(stderr, "%s: option '--%s' doesn't allow an argument\n", command, found->name);
}

int next_option(int argc, char **argv, const char *letters, const struct option *list)
{
    opterr           = 0;
    const int option = getopt_long(argc, argv, letters, list, NULL);
    if (option == '?') print_error(argv[0], argv[optind > 0 ? optind - 1 : 0], letters, list);
    return option;
}
