// The main function of every test program, for both versions of Catch2.
#define CATCH_CONFIG_RUNNER
#include "tests/support/catch.h"

int main(int argc, char* argv[]) {
    return Catch::Session().run(argc, argv);
}
