/* render/frame/plane_type.h: what a plane's values are; for C++ too. */
#ifndef RENDER_FRAME_PLANE_TYPE_H
#define RENDER_FRAME_PLANE_TYPE_H

/* C64: two floats, real, imaginary. */
typedef enum PlaneType { PLANE_F32, PLANE_U32, PLANE_F64, PLANE_C64, PLANE_U8 } PlaneType;

#endif
