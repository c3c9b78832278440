/* sensor/score/json_member.h: members of a JSON object that another program wrote, checked one by one. */
#ifndef SENSOR_SCORE_JSON_MEMBER_H
#define SENSOR_SCORE_JSON_MEMBER_H

#include "dis/pdu/pdu.h"
#include "render/scene/view.h"
#include "sensor/frame/json_object.h"

/* Parses a piece. STATUS_BAD_VALUE, not logged: it is not JSON; STATUS_NO_MEMORY. *out is then NULL. */
static inline Status json_member_load(json_t **out, const char *text, size_t length)
{
    json_error_t error;
    *out = json_loadb(text, length, 0, &error);
    if (*out) return STATUS_OK;
    return json_error_code(&error) == json_error_out_of_memory ? STATUS_NO_MEMORY : STATUS_BAD_VALUE;
}

/* A finite number; NaN: absent, null or none. */
static inline double json_member_number(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : NAN;
}

/* A whole number in low .. high; false: it is none. */
static inline bool json_member_whole(long long *out, const json_t *object, const char *key, long long low,
                                     long long high)
{
    const json_t *value = json_object_get(object, key);
    const double  number = json_is_number(value) ? json_number_value(value) : NAN;
    if (!(number >= (double)low && number <= (double)high) || number != floor(number)) return false;
    *out = json_is_integer(value) ? (long long)json_integer_value(value) : (long long)number;
    return true;
}

/* A list of exactly so many numbers, each of at most 1e9; false: it is none. */
static inline bool json_member_numbers(double *out, int count, const json_t *object, const char *key)
{
    const json_t *list = json_object_get(object, key);
    if (!json_is_array(list) || json_array_size(list) != (size_t)count) return false;
    for (int i = 0; i < count; i++) {
        const json_t *item = json_array_get(list, (size_t)i);
        out[i] = json_is_number(item) ? json_number_value(item) : NAN;
        if (!(fabs(out[i]) <= 1e9)) return false;
    }
    return true;
}

/* -1: no band's name. */
static inline int json_member_band(const json_t *object, const char *key)
{
    const char *name = json_string_value(json_object_get(object, key));
    for (int b = 0; name && b < BAND_COUNT; b++)
        if (strcmp(name, band_name((Band)b)) == 0) return b;
    return -1;
}

/* An entity's id as one number, in the ids' order. False: it is none. */
static inline bool json_member_entity(uint64_t *out, const json_t *object)
{
    DisEntityId id;
    const char *text = json_string_value(json_object_get(object, "entity"));
    if (!text || !dis_entity_id_parse(&id, text)) return false;
    *out = (uint64_t)id.site << 32 | (uint64_t)id.application << 16 | id.entity;
    return true;
}

/* The same number as text. */
static inline void json_member_entity_text(char out[dis_id_text_size], uint64_t entity)
{
    const DisEntityId id = {(uint16_t)(entity >> 32), (uint16_t)(entity >> 16), (uint16_t)entity};
    dis_entity_id_text(out, id);
}

#endif
