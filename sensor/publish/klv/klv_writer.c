/* sensor/publish/klv/klv_writer.c: key, length, value into a bounded buffer. */
#include "sensor/publish/klv/klv_writer_private.h"

void klv_put(KlvWriter *w, const void *octets, size_t count)
{
    if (w->full || count > w->room - w->used) {
        w->full = true;
        return;
    }
    if (count > 0) memcpy(w->octet + w->used, octets, count);
    w->used += count;
}

void klv_put_number(KlvWriter *w, uint64_t value, int octets)
{
    uint8_t text[8];
    for (int i = 0; i < octets; i++) text[i] = (uint8_t)(value >> (8 * (octets - 1 - i)));
    klv_put(w, text, (size_t)octets);
}

static int octets_of(uint64_t value)
{
    int octets = 1;
    while (octets < 8 && value >> (8 * octets)) octets++;
    return octets;
}

void klv_put_length(KlvWriter *w, size_t length)
{
    const int octets = octets_of(length);
    if (length >= 128) klv_put_number(w, 0x80u | (unsigned)octets, 1);
    klv_put_number(w, length, octets);
}

void klv_put_oid(KlvWriter *w, uint64_t value)
{
    int groups = 1;
    while (groups < 10 && value >> (7 * groups)) groups++;
    for (int k = groups - 1; k >= 0; k--) klv_put_number(w, (value >> (7 * k) & 0x7F) | (k > 0 ? 0x80u : 0), 1);
}

void klv_item(KlvWriter *w, unsigned tag, const void *octets, size_t count)
{
    klv_put_oid(w, tag);
    klv_put_length(w, count);
    klv_put(w, octets, count);
}

void klv_item_number(KlvWriter *w, unsigned tag, uint64_t value, int octets)
{
    klv_put_oid(w, tag);
    klv_put_length(w, (size_t)octets);
    klv_put_number(w, value, octets);
}

void klv_item_short(KlvWriter *w, unsigned tag, uint64_t value) { klv_item_number(w, tag, value, octets_of(value)); }

void klv_item_text(KlvWriter *w, unsigned tag, const char *text, size_t most)
{
    char   kept[128];
    size_t count = 0;
    if (most > sizeof kept) most = sizeof kept;
    for (; text && *text && count < most; text++)
        if (*text >= (count > 0 ? 0x20 : 0x21) && *text <= 0x7E) kept[count++] = *text;
    while (count > 0 && kept[count - 1] == ' ') count--;
    if (count > 0) klv_item(w, tag, kept, count);
}

void klv_item_unsigned(KlvWriter *w, unsigned tag, int octets, double low, double high, double value)
{
    const double steps = ldexp(1, 8 * octets) - 1;
    if (!(value >= low && value <= high)) return;
    klv_item_number(w, tag, (uint64_t)floor((value - low) / (high - low) * steps + 0.5), octets);
}

void klv_item_signed(KlvWriter *w, unsigned tag, int octets, double high, double value)
{
    const double steps = ldexp(1, 8 * octets - 1) - 1;
    if (!(fabs(value) <= high)) return;
    klv_item_number(w, tag, (uint64_t)(int64_t)floor(value / high * steps + 0.5), octets);
}

void klv_put_imapb(KlvWriter *w, int octets, double low, double high, double value)
{
    const double scale = ldexp(1, 8 * octets - 1 - (int)ceil(log2(high - low)));
    const double zero = low < 0 && high > 0 ? scale * low - floor(scale * low) : 0;
    klv_put_number(w, (uint64_t)floor(scale * (value - low) + zero), octets);
}

void klv_item_imapb(KlvWriter *w, unsigned tag, int octets, double low, double high, double value)
{
    if (!(value >= low && value <= high)) return;
    klv_put_oid(w, tag);
    klv_put_length(w, (size_t)octets);
    klv_put_imapb(w, octets, low, high, value);
}

uint16_t klv_checksum(const uint8_t *octets, size_t count)
{
    uint32_t sum = 0;
    for (size_t i = 0; i < count; i++) sum += (uint32_t)octets[i] << (8 * ((i + 1) % 2));
    return (uint16_t)sum;
}
