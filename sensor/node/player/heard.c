/* sensor/node/player/heard.c: a growing list of datagrams, and its end. */
#include "sensor/node/player/heard.h"

#include <stdlib.h>

Status heard_add(Heard *heard, const DisDatagram *datagram)
{
    enum { begin = 4096 };
    if (heard->count == heard->capacity) {
        const int    larger = heard->capacity ? 2 * heard->capacity : begin;
        DisDatagram *grown = realloc(heard->datagram, (size_t)larger * sizeof *grown);
        if (!grown) return STATUS_NO_MEMORY;
        heard->datagram = grown;
        heard->capacity = larger;
    }
    uint8_t *bytes = malloc(datagram->octets + 1);
    if (!bytes) return STATUS_NO_MEMORY;
    memcpy(bytes, datagram->bytes, datagram->octets);
    heard->datagram[heard->count] = *datagram;
    heard->datagram[heard->count++].bytes = bytes;
    return STATUS_OK;
}

void heard_drop(Heard *heard, int count)
{
    for (int i = 0; i < count; i++) free((void *)(uintptr_t)heard->datagram[i].bytes);
    heard->count -= count;
    if (heard->count) memmove(heard->datagram, heard->datagram + count, (size_t)heard->count * sizeof *heard->datagram);
}

void heard_free(Heard *heard)
{
    heard_drop(heard, heard->count);
    free(heard->datagram);
    *heard = (Heard){0};
}
