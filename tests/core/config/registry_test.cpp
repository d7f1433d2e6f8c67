#include "core/config/registry.h"

#include "tests/support/error_of.h"
#include "tests/support/catch.h"

namespace {

using namespace ulam;

struct Animal {
    virtual ~Animal() = default;
    virtual std::string sound() const = 0;
    static const char* kind() { return "animal"; }
    static std::vector<std::string> commonKeys() { return {"weight"}; }
};

class Dog : public Animal {
public:
    struct Parameters {
        int barks = 2;
        template <class V>
        void describe(V& v) {
            v("barks", barks, {.help = "how often", .min = 0, .max = 5});
        }
    };
    explicit Dog(const Parameters& parameters) : parameters_(parameters) {}
    std::string sound() const override {
        std::string result;
        for (int i = 0; i < parameters_.barks; ++i) result += "wuff ";
        return result;
    }

private:
    Parameters parameters_;
};

class Cat : public Animal {
public:
    struct Parameters {
        template <class V>
        void describe(V&) {}
    };
    explicit Cat(const Parameters&) {}
    std::string sound() const override { return "miau"; }
};

ULAM_REGISTER(Animal, Dog, "dog", "barks");
ULAM_REGISTER(Animal, Cat, "cat", "purrs");

struct Plant {
    static const char* kind() { return "plant"; }
};

struct Tree : Plant {
    struct Parameters {
        double height = -1;
        template <class V>
        void describe(V& v) {
            v("height", height, {.help = "of the crown", .unit = "metres", .min = 0});
        }
    };
    explicit Tree(const Parameters&) {}
};

JsonNode node(const std::string& text) {
    return JsonDocument::fromText(text, "zoo.json").root();
}

const Registry<Animal>& animals() {
    return Registry<Animal>::instance();
}

}  // namespace

TEST_CASE("registered things are listed by name with what is known about them", "[registry]") {
    const auto entries = animals().entries();
    REQUIRE(entries.size() == 2);
    CHECK(animals().names() == std::vector<std::string>{"cat", "dog"});
    CHECK(animals().contains("dog"));
    CHECK_FALSE(animals().contains("do"));
    CHECK(entries[0]->name == "cat");
    CHECK(entries[1]->name == "dog");
    CHECK(entries[1]->summary == "barks");
    CHECK(entries[1]->file == "registry_test.cpp");
    REQUIRE(entries[1]->parameters.size() == 1);
    CHECK(entries[1]->parameters[0].name == "barks");
    CHECK(entries[0]->parameters.empty());
}

TEST_CASE("things are made from their parameters", "[registry]") {
    CHECK(animals().create(node(R"({"type": "dog", "barks": 1})"))->sound() == "wuff ");
    CHECK(animals().create(node(R"({"type": "cat"})"))->sound() == "miau");
    const JsonNode keyed = node(R"({"dog": {"weight": 3}})");
    CHECK(animals().find("dog", keyed.at("dog")).create(keyed.at("dog"))->sound() == "wuff wuff ");
    CHECK(animals().find("dog", keyed).resolve(keyed.at("dog")) == Json{{"barks", 2}});
}

TEST_CASE("mistakes in what is asked for are named with their place", "[registry]") {
    const auto message = [](const std::string& text) {
        const auto complaint = errorOf([&] { animals().create(node(text)); });
        CHECK(complaint.code == ExitCode::InvalidConfig);
        return complaint.message;
    };
    CHECK(message(R"({"type": "dgo"})") ==
          "unknown animal \"dgo\" at zoo.json:1:10 (/type); did you mean \"dog\"? Known: \"cat\", \"dog\"");
    CHECK(message(R"({"type": "elephant"})") ==
          "unknown animal \"elephant\" at zoo.json:1:10 (/type); Known: \"cat\", \"dog\"");
    CHECK(message(R"({"typ": "dog"})") == "\"type\" is missing from the object at zoo.json:1:1; it has \"typ\"");
    CHECK(message(R"({"type": 3})") == "expected a string, found 3 at zoo.json:1:10 (/type)");
    CHECK(message(R"({"type": "dog", "barks": 9})").find("0 <= x <= 5 for \"barks\", found 9 at zoo.json:1:26") !=
          std::string::npos);
    CHECK(message(R"({"type": "dog", "bark": 1})")
              .find("unknown parameter \"bark\" at zoo.json:1:25 (/bark); did you "
                    "mean \"barks\"?") == 0);
}

TEST_CASE("a name that is taken is refused with both files", "[registry]") {
    Registry<Animal> registry;
    registry.add({"dog", "one", "a.cpp", {}, {}, {}});
    CHECK(errorOf([&] {
              registry.add({"dog", "two", "b.cpp", {}, {}, {}});
          }).message == "animal \"dog\" is registered twice, in a.cpp and in b.cpp");
    CHECK(registry.entries().size() == 1);
}

TEST_CASE("a broken registration is reported at the first use", "[registry]") {
    CHECK_NOTHROW(Registration<Plant, Tree>("tree", "grows", "/somewhere/tree.cpp"));
    const auto complaint = errorOf([] { Registry<Plant>::instance().entries(); });
    CHECK(complaint.code == ExitCode::InvalidConfig);
    CHECK(complaint.has("tree.cpp: the default or example of parameter \"height\" breaks its own description"));
}
