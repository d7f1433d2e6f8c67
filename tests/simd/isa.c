// Preloaded, has Embree use the instructions that $ULAM_TEST_ISA names.

#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>

void* rtcNewDevice(const char* config) {
    char text[256];
    snprintf(text, sizeof text, "%s,isa=%s", config, getenv("ULAM_TEST_ISA"));
    void* (*make)(const char*) = (void* (*)(const char*))dlsym(RTLD_NEXT, "rtcNewDevice");
    return make(text);
}
