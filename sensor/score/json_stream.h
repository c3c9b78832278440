/* sensor/score/json_stream.h: large files of JSON, a piece at a time: the lines of JSONL, and the items of lists in one
 * document. Memory is that of the largest piece, at most `most` octets.
 *
 * The pieces are cut out here; what they mean, jansson says. Failures are logged as `score: FILE:LINE: ...`. */
#ifndef SENSOR_SCORE_JSON_STREAM_H
#define SENSOR_SCORE_JSON_STREAM_H

#include "pitviper.h"

typedef struct JsonStream {
    FILE  *file;
    char   path[4096];
    long   line; /* of the piece, from 1 */
    char  *text; /* the piece, terminated */
    size_t length, room, most;
    bool   cut;     /* the file ends within a line, without a newline */
    long   at_line; /* of the next octet */
} JsonStream;

/* STATUS_IO, logged. most: octets of a piece. */
Status json_stream_open(JsonStream *out, const char *path, size_t most);
/* A stream of one's own, which close closes; path for messages. */
void json_stream_of(JsonStream *out, FILE *file, const char *path, size_t most);
/* May be zeroed or closed. */
void json_stream_close(JsonStream *s);

/* The next line that is not blank, without its newline. *more false: the end. STATUS_BAD_VALUE: too long; STATUS_IO;
 * STATUS_NO_MEMORY. */
Status json_stream_line(bool *more, JsonStream *s);
/* The first octet that is not blank, which stays to be read; EOF. */
int json_stream_peek(JsonStream *s);

/* Walks the lists of a document: an object's, by their keys, or the one that the document is, whose key is "". Begin at
 * the start; *more false: the document has ended. Other values are passed over, and so is what is left of a list. At
 * most 64 levels. */
typedef struct JsonLists {
    JsonStream *stream;
    char        key[32];                      /* cut */
    bool        begun, in_list, first, whole; /* whole: the document is a list */
} JsonLists;
Status json_lists_next(bool *more, JsonLists *lists);
/* The next item of the list, in stream->text. */
Status json_lists_item(bool *more, JsonLists *lists);

#endif
