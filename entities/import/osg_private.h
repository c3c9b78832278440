/* entities/import/osg_private.h: OpenSceneGraph's text form as a tree: one element per line, `{` opens its children. */
#ifndef ENTITIES_IMPORT_OSG_PRIVATE_H
#define ENTITIES_IMPORT_OSG_PRIVATE_H

#include "pitviper.h"

typedef struct OsgElement {
    int first_word, words;
    int child, next; /* -1: none */
} OsgElement;

typedef struct Text {
    const char *path;
    int element_count, element_room, word_count, word_room;
    OsgElement *element;
    char **word;
    int *by_id; /* element with this UniqueID that has more than the id; -1 */
    int id_count;
} OsgText;

/* The tree of a text, which is split in place and must outlive it. STATUS_BAD_VALUE, not logged: it is
 * incomplete. Close it whatever open returns. */
Status osg_text_open(OsgText *out, const char *path, char *text, size_t octets);
void   osg_text_close(OsgText *text);

const char *osg_word(const OsgText *x, int element, int index); /* "": there is none */
/* The child with this first word; -1: none. */
int    osg_find(const OsgText *x, int element, const char *name);
/* A repeated object is written as its id alone: the element with the full definition. */
int    osg_resolve(const OsgText *x, int element);
/* Numbers among an element's words from `from` on; false when there are fewer than count. */
bool   osg_numbers(double *out, int count, const OsgText *x, int element, int from);

#endif
