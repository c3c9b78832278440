/* pitviper_yaml.c: the subset of YAML that input files may use, checked before parsing. The time of libyaml is
 * quadratic in the depth of nesting, the number of anchors and the number of directives: seconds, or hours, for a
 * megabyte. */
#include "pitviper.h"

#include <yaml.h>

enum { most_depth = 32, most_anchors = 256, most_directives = 8 };

typedef struct Tally {
    int depth, anchors, documents;
} Tally;

static const char *too_much(Tally *tally, const yaml_event_t *event)
{
    const yaml_char_t *anchor = NULL;
    switch (event->type) {
    case YAML_DOCUMENT_START_EVENT: tally->documents++; break;
    case YAML_SCALAR_EVENT: anchor = event->data.scalar.anchor; break;
    case YAML_SEQUENCE_START_EVENT: anchor = event->data.sequence_start.anchor, tally->depth++; break;
    case YAML_MAPPING_START_EVENT: anchor = event->data.mapping_start.anchor, tally->depth++; break;
    case YAML_SEQUENCE_END_EVENT:
    case YAML_MAPPING_END_EVENT: tally->depth--; break;
    default: break;
    }
    tally->anchors += anchor != NULL;
    return tally->depth > most_depth       ? "lists and mappings nest deeper than 32"
           : tally->anchors > most_anchors ? "more than 256 anchors"
           : tally->documents > 1          ? "a second document; only one is read"
                                           : NULL;
}

Status yaml_check(const char *module, const char *path, const char *text, size_t octets)
{
    yaml_parser_t parser;
    yaml_event_t  event;
    Tally         tally = {0};
    const char   *reason = NULL;
    int           line = 1, directives = 0;
    bool          more = true;
    Status        status = STATUS_OK;

    for (size_t i = 0; i < octets && !reason; i++) {
        directives += text[i] == '%' && (i == 0 || strchr("\r\n", text[i - 1]));
        reason = !text[i] ? "holds a NUL octet; is it UTF-8 text?" : NULL;
        if (directives > most_directives) reason = "more than 8 directives";
        line += text[i] == '\n';
    }
    if (!reason) {
        if (!yaml_parser_initialize(&parser)) return STATUS_NO_MEMORY;
        yaml_parser_set_input_string(&parser, (const unsigned char *)text, octets);
        while (more && !reason && (more = yaml_parser_parse(&parser, &event))) {
            more = event.type != YAML_STREAM_END_EVENT;
            reason = too_much(&tally, &event);
            line = (int)event.start_mark.line + 1;
            yaml_event_delete(&event);
        }
        if (parser.error == YAML_MEMORY_ERROR) status = STATUS_NO_MEMORY;
        else if (parser.error) reason = parser.problem, line = (int)parser.problem_mark.line + 1;
        yaml_parser_delete(&parser);
    }
    if (!reason) return status;
    log_error("%s: %s:%d: %s", module, path, line, reason);
    return STATUS_BAD_VALUE;
}
