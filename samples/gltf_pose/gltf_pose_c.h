/* SPDX-License-Identifier: MIT */
/* gltf_pose.h for the sample in C. */
#pragma once

#include "spherechain/spherechain.h"

#if defined(__cplusplus)
extern "C" {
#endif

typedef struct gltf_character gltf_character;

/* Null, and the reason in `message`, where the file is no skinned glTF with a clip. */
gltf_character* gltf_open(const char* path, char* message, size_t message_size);
void gltf_close(gltf_character* character);

/* The joints in the order of the palette; their inverse bind matrices are SC_COLUMNS_4X4. */
const sc_bone* gltf_joints(const gltf_character* character, size_t* count);
double gltf_duration(const gltf_character* character);

/* The palette of the first clip at this time, 16 floats a joint. Valid until the next call. */
const float* gltf_palette(gltf_character* character, double seconds);

#if defined(__cplusplus)
}
#endif
