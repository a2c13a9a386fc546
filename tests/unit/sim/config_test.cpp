#include "sim/config.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "sim/files.h"
#include "sim/nearest.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"

namespace marti::sim {
namespace {

using test::user_error_of;

enum class Replacement { lru, fifo, random };

Schema example() {
  Schema schema;
  schema.section("cache", "The private cache of a node.");
  schema.size("cache.size", "16 KiB", {"0 B", "1 GiB"}, "Capacity; 0 leaves the cache out");
  schema.choice("cache.replacement", "lru", {"lru", "fifo", "random"}, "Which line is replaced");
  schema.integer("cache.ways", 4, {1, std::nullopt}, "lines", "Lines in a set");
  schema.boolean("cache.split", false, "One cache for each kind of record");
  schema.integer("nodes", 16, {1, 65536}, "nodes", "Processor nodes");
  schema.frequency("node.clock", "33 MHz", {"1 kHz", "10 GHz"}, "Clock of a node");
  schema.duration("bus.latency", "10 ns", {"0 ps", "1 s"}, "Time to win the bus");
  schema.real("camera.view", 45.0, {0.001, 179.0}, "degrees", "Vertical angle of view");
  schema.text("scene.file", "teapot:12", "Scene");
  schema.percentage("render.cut", "1 %", {"0 %", "100 %"}, "Weight below which rays end");
  schema.integers("sweep.nodes", {1, 2}, {1, 100}, "nodes", "Machines");
  schema.texts("sweep.scenes", {}, "Scenes");
  schema.reals("sweep.views", {}, {}, "", "Views");
  return schema;
}

Config read(std::string_view text, std::vector<std::string> assignments = {}) {
  return Config::from_text(example(), text, "a.toml", assignments);
}

std::string error_of(std::string_view text, const std::vector<std::string>& assignments = {}) {
  return user_error_of([&] { (void)read(text, assignments); });
}

// Given in the file, in an assignment, or as the text that it was printed as, it is one value; a text is as
// it was.
TEST(Config, ACompositeIsKeptAsTomlInOneLine) {
  Schema schema;
  schema.text_or_composite("scene.source", "teapot:12", "Scene");
  const auto value = [&](std::string_view text, std::vector<std::string> assignments = {}) {
    const Config config = Config::from_text(schema, text, "a.toml", assignments);
    const Config again = Config::from_text(
        schema, "scene.source = " + print_values(schema.keys()[0], config.values("scene.source")), "b.toml");
    EXPECT_EQ(again.text("scene.source"), config.text("scene.source"));
    return config.text("scene.source");
  };
  const std::string both = "['a b.obj', {source = \"it's\", scale = [1, 2.5], deep = {on = true}}]";
  EXPECT_EQ(value("[scene]\nsource = [\n  \"a b.obj\", # first\n  { source = \"it's\", scale = [1, 2.5], "
                  "deep.on = true },\n]\n"),
            both);
  EXPECT_EQ(value("[[scene.source]]\n'a \"name\"' = 1\n"), "[{'a \"name\"' = 1}]");
  EXPECT_EQ(value("", {"scene.source=['a b.obj', {source=\"it's\",scale=[1,2.5],deep={on=true}}]"}), both);
  EXPECT_EQ(value("", {"scene.source={source=\"a\"}"}), "{source = 'a'}");
  EXPECT_EQ(value("scene.source = \"a[1]\""), "a[1]");
  EXPECT_EQ(
      user_error_of([&] { (void)value("scene.source = 3"); }),
      "a.toml:1: scene.source: must be a text in quotation marks, a list or a table, not the integer 3");
}

// What a message says of its place, programs need not look for in it.
TEST(Config, ErrorsHaveTheirPlace) {
  using Parts = std::tuple<std::string, int, std::string>;
  const auto place_of = [](const auto& work) -> Parts {
    try {
      (void)work();
    } catch (const UserError& error) {
      EXPECT_TRUE(std::string_view(error.what()).starts_with(error.place().text)) << error.what();
      return {error.place().file, error.place().line, error.place().key};
    }
    return {};
  };
  EXPECT_EQ(place_of([] { return read("\n[cache]\nsize = \"3 apples\""); }),
            (Parts{"a.toml", 3, "cache.size"}));
  EXPECT_EQ(place_of([] { return read("[cache]\nsiz = 3"); }), (Parts{"a.toml", 2, "cache.siz"}));
  EXPECT_EQ(place_of([] { return read("[cache]\nsize = 3 apples"); }), (Parts{"a.toml", 2, "cache.size"}));
  EXPECT_EQ(place_of([] { return read("", {"nodes=none"}); }), (Parts{"", 0, "nodes"}));
  EXPECT_EQ(place_of([] { return read("", {"nodes"}); }), (Parts{"", 0, ""}));
  const Config config = read("nodes = 4");
  EXPECT_EQ(place_of([&]() -> int { config.fail("nodes", "is odd"); }), (Parts{"a.toml", 1, "nodes"}));
  EXPECT_EQ(place_of([&]() -> int { config.fail("cache.size", "is odd"); }),
            (Parts{"a.toml", 0, "cache.size"}));
}

TEST(Config, DefaultsHoldWhereNothingIsGiven) {
  const Config config = read("");
  EXPECT_EQ(config.size("cache.size"), 16 * 1024);
  EXPECT_EQ(config.choice_as<Replacement>("cache.replacement"), Replacement::lru);
  EXPECT_EQ(config.integer("nodes"), 16);
  EXPECT_EQ(config.frequency("node.clock"), 33e6);
  EXPECT_EQ(config.duration("bus.latency"), 10'000);
  EXPECT_EQ(config.real("camera.view"), 45.0);
  EXPECT_EQ(config.text("scene.file"), "teapot:12");
  EXPECT_EQ(config.percentage("render.cut"), 0.01);
  EXPECT_EQ(config.integers("sweep.nodes"), (std::vector<std::int64_t>{1, 2}));
  EXPECT_TRUE(config.texts("sweep.scenes").empty());
  EXPECT_FALSE(config.boolean("cache.split"));
  EXPECT_FALSE(config.given("nodes"));
  EXPECT_EQ(config.where("nodes"), "default");
}

TEST(Config, ValuesAreReadWithTheirUnits) {
  const Config config = read(
      "nodes = 64\n"
      "[cache]\nsize = \"32 KiB\" # twice\nreplacement = 'random'\nsplit = true\n"
      "[node]\nclock = \"40 MHz\"\n"
      "[camera]\nview = 30\n"
      "[sweep]\nnodes = [1, 4,\n 16]\nviews = [0.5, 2]\n");
  EXPECT_EQ(config.integer("nodes"), 64);
  EXPECT_EQ(config.size("cache.size"), 32 * 1024);
  EXPECT_EQ(config.choice("cache.replacement"), 2U);
  EXPECT_EQ(config.choice_name("cache.replacement"), "random");
  EXPECT_TRUE(config.boolean("cache.split"));
  EXPECT_EQ(config.frequency("node.clock"), 40e6);
  EXPECT_EQ(config.real("camera.view"), 30.0);
  EXPECT_EQ(config.integers("sweep.nodes"), (std::vector<std::int64_t>{1, 4, 16}));
  EXPECT_EQ(config.reals("sweep.views"), (std::vector<double>{0.5, 2.0}));
  EXPECT_TRUE(config.given("cache.size"));
  EXPECT_EQ(config.where("cache.size"), "a.toml:3");
}

TEST(Config, AssignmentsOverrideTheFile) {
  const Config config =
      read("nodes = 64\ncache.size = \"8 KiB\"\n",
           {"nodes=2", "nodes=3", "cache.size=32KiB", "cache.replacement=fifo", "scene.file=12",
            "sweep.nodes=[5, 6]", "bus.latency = \"5 ns\"", "sweep.scenes=['a=b', \"c\"]"});
  EXPECT_EQ(config.integer("nodes"), 3);
  EXPECT_EQ(config.where("nodes"), "--set nodes=3");
  EXPECT_EQ(config.size("cache.size"), 32 * 1024);
  EXPECT_EQ(config.choice_name("cache.replacement"), "fifo");
  EXPECT_EQ(config.text("scene.file"), "12");
  EXPECT_EQ(config.integers("sweep.nodes"), (std::vector<std::int64_t>{5, 6}));
  EXPECT_EQ(config.duration("bus.latency"), 5'000);
  EXPECT_EQ(config.texts("sweep.scenes"), (std::vector<std::string>{"a=b", "c"}));
}

struct Wrong {
  const char* text;
  const char* message;
};

TEST(Config, WrongInputIsNamedWithFileLineAndKey) {
  for (
      const Wrong& wrong : std::initializer_list<Wrong>{
          {"\n[cache]\nsice = 3\n",
           "a.toml:3: cache.sice: unknown key (did you mean \"cache.size\"?); `marti config` lists all keys"},
          {"size = 3\n",
           "a.toml:1: size: unknown key (did you mean \"cache.size\"?); `marti config` lists all keys"},
          {"zzzzzzzzzz = 3", "a.toml:1: zzzzzzzzzz: unknown key; `marti config` lists all keys"},
          {"[cahce]\n", "a.toml:1: cahce: unknown section; `marti config` lists all keys"},
          {"[cahce]\nsize = 3\n",
           "a.toml:2: cahce.size: unknown key (did you mean \"cache.size\"?); `marti config` lists all keys"},
          {"bus = 3", "a.toml:1: bus: is a section and has no value of its own; its keys are bus.latency"},
          {"nodes = { a = 1 }", "a.toml:1: nodes: must be an integer, not a table"},
          {"[[nodes]]\n", "a.toml:1: nodes: must be an integer, not a list"},
          {"\"cache.size\" = 3",
           "a.toml:1: \"cache.size\": unknown key (did you mean \"cache.size\"?); `marti config` lists all "
           "keys"},
          {"[cache]\nsize = true", "a.toml:2: cache.size: must be a size such as \"16 KiB\", not a boolean"},
          {"cache.size = -3", "a.toml:1: cache.size: must be a size such as \"16 KiB\", not the integer -3"},
          {"cache.size = \"3 KB\"",
           "a.toml:1: cache.size: \"3 KB\": the unit KB is ambiguous: write KiB, MiB or GiB (powers of "
           "1024)"},
          {"cache.size = \"2 GiB\"", "a.toml:1: cache.size: must be 0 B to 1 GiB, not \"2 GiB\""},
          {"nodes = 0", "a.toml:1: nodes: must be 1 to 65536 (nodes), not 0"},
          {"cache.ways = 0", "a.toml:1: cache.ways: must be at least 1 (lines), not 0"},
          {"nodes = 1.0", "a.toml:1: nodes: must be an integer, not the real 1"},
          {"nodes = \"3\"", "a.toml:1: nodes: must be an integer, not the text \"3\""},
          {"nodes = 1979-05-27", "a.toml:1: nodes: must be an integer, not a date or time"},
          {"camera.view = nan", "a.toml:1: camera.view: must be a number, not the real nan"},
          {"sweep.views = [1, inf]", "a.toml:1: sweep.views: must be a number, not the real inf"},
          {"sweep.nodes = 3",
           "a.toml:1: sweep.nodes: must be a list in brackets, each an integer, not the integer 3"},
          {"sweep.nodes = [1, \"a\"]", "a.toml:1: sweep.nodes: must be an integer, not the text \"a\""},
          {"sweep.nodes = [1, 200]", "a.toml:1: sweep.nodes: must be 1 to 100 (nodes), not 200"},
          {"cache.replacement = \"lry\"",
           "a.toml:1: cache.replacement: must be lru, fifo or random, not \"lry\" (did you mean \"lru\"?)"},
          {"node.clock = 33",
           "a.toml:1: node.clock: must be a frequency such as \"33 MHz\", not the integer 33"},
          {"cache.replacement = 4",
           "a.toml:1: cache.replacement: must be lru, fifo or random in quotation marks, not the integer 4"},
          {"scene.file = 3", "a.toml:1: scene.file: must be a text in quotation marks, not the integer 3"},
          {"nodes = 2\nwhat = 1\nnodez = 3", "a.toml:2: what: unknown key; `marti config` lists all keys"}}) {
    EXPECT_EQ(error_of(wrong.text), wrong.message) << wrong.text;
  }
}

TEST(Config, WrongAssignmentsAreNamed) {
  for (const Wrong& wrong : std::initializer_list<Wrong>{
           {"nodes", "--set nodes: must have the form key=value"},
           {"=3", "--set =3: must have the form key=value"},
           {"nodes=", "--set nodes=: the value is missing; it must be an integer"},
           {"nodse=3", "--set nodse=3: unknown key (did you mean \"nodes\"?); `marti config` lists all keys"},
           {"nodes=x", "--set nodes=x: must be an integer, not the text \"x\""},
           {"nodes=0", "--set nodes=0: must be 1 to 65536 (nodes), not 0"},
           {"cache=3",
            "--set cache=3: is a section and has no value of its own; its keys are cache.size, "
            "cache.replacement, cache.ways, cache.split"},
           {"nodes=1\ncache.ways=2",
            "--set nodes=1\\ncache.ways=2: must be an integer, not the text \"1\\ncache.ways=2\""}}) {
    EXPECT_EQ(error_of("", {wrong.text}), wrong.message) << wrong.text;
  }
}

TEST(Config, MalformedTomlIsNamedWithLineAndColumn) {
  for (const char* text : {"nodes = ", "nodes 3", "[cache", "nodes = 3\nnodes = 4", "[cache]\n[cache]\n",
                           "nodes = 99999999999999999999", "a = \"\xff\xfe\"", "\xff\xfen\0o\0", "nodes = \"",
                           "nodes = 3 cache.ways = 2", "nodes = 1\x01", "[cache]\nways=1\n[[cache]]\n"}) {
    const std::string message = error_of(text);
    EXPECT_EQ(message.rfind("a.toml:", 0), 0U) << text << ": " << message;
    EXPECT_NE(message.find(':', 7), std::string::npos) << message;
  }
  EXPECT_EQ(error_of("nodes = 3\nnodes 4").rfind("a.toml:2:", 0), 0U);
}

// Also where the line has no '=', or is only a part of a list or an inline table.
TEST(Config, MalformedTomlIsNamedWithTheKeyThatIsRead) {
  const struct {
    const char* text;
    const char* place;
  } wrong[] = {{"[cache]\nways 4\n", "a.toml:2:6: cache.ways: "},
               {"[cache]\nways: 4\n", "a.toml:2:5: cache.ways: "},
               {"[cache]\nways = 4\n\nfoo\n", "a.toml:4:4: cache.foo: "},
               {"[cache]\nways = \n", "a.toml:2:8: cache.ways: "},
               {"[cache]\nways = 4 5\n", "a.toml:2:10: cache.ways: "},
               {"[cache\nways = 4\n", "a.toml:1:7: cache: "},
               {"[ca che]\n", "a.toml:1:5: ca: "},
               {"[cache]\nways = 1\n[cache]\n", "a.toml:3:1: cache: "},
               {"[a]\n\"b.c\" = [1,2 # ]\n[cache]\nways = 1\n", "a.toml:3:1: a.\"b.c\": "},
               {"a = [1,\n 2 3]\n", "a.toml:2:4: a: "},
               {"a = [1, [2, {b = 3, c = }]]\n", "a.toml:1:25: a.c: "},
               {"a = { b = 1, c = }\n", "a.toml:1:18: a.c: "},
               {"[a]\nb = \"\"\"\nc = 1\n", "a.toml:3:7: a.b: "},
               {"[a]\nb = '''\n[c] d = '''\ne f\n", "a.toml:4:3: a.e: "},
               {"a = \"\u00e4\u00f6\" b\n", "a.toml:1:10: a: "}};
  for (const auto& [text, place] : wrong) {
    EXPECT_EQ(error_of(text).rfind(place, 0), 0U) << text << error_of(text);
  }
}

// toml++ asserts that a name begins where a name must.
TEST(Config, WhatBeginsNoNameIsNamed) {
  const struct {
    const char* text;
    const char* place;
  } wrong[] = {{"[#]\n", "a.toml:1:2: "},      {"[[=]]\n", "a.toml:1:3: "}, {"[ ", "a.toml:1:"},
               {"[a.#]\n", "a.toml:1:4: "},    {"a.= 1\n", "a.toml:1:3: "}, {"=1\n", "a.toml:1:1: "},
               {"a = {=1}\n", "a.toml:1:6: "}, {"\n[", "a.toml:2:"}};
  for (const auto& [text, place] : wrong) {
    EXPECT_EQ(error_of(text).rfind(place, 0), 0U) << text << error_of(text);
  }
}

TEST(Config, QuotationMarksAreAdvisedForTextsAlone) {
  EXPECT_NE(error_of("cache.size = 16 KiB\n").find("cache.size = \"16 KiB\""), std::string::npos);
  EXPECT_NE(error_of("cache.size =\n").find("the value is missing"), std::string::npos);
  for (const char* text : {"nodes = 4\nnodes = 5\n", "nodes = 0123\n", "nodes = 1__0\n"}) {
    EXPECT_EQ(error_of(text).find("quotation"), std::string::npos) << error_of(text);
  }
}

TEST(Config, HostileDepthIsRefused) {
  std::string dotted = "a";
  for (int i = 0; i < 200'000; ++i) {
    dotted += ".a";
  }
  EXPECT_NE(error_of(dotted + " = 1").find("parts"), std::string::npos);
  EXPECT_NE(error_of("[" + dotted + "]").find("parts"), std::string::npos);
  EXPECT_NE(error_of("nodes = { " + dotted + " = 1 }").find("parts"), std::string::npos);
  EXPECT_NE(error_of("", {"nodes={" + dotted + "=1}"}).find("parts"), std::string::npos);
  EXPECT_NE(error_of("nodes = " + std::string(100'000, '[')), "no UserError");
  std::string tables = "nodes = ";
  for (int i = 0; i < 100'000; ++i) {
    tables += "{a=";
  }
  EXPECT_NE(error_of(tables), "no UserError");
  EXPECT_EQ(error_of("# " + std::string(500, '.') + "\nsweep.views = [" +
                     [] {
                       std::string reals;
                       for (int i = 0; i < 500; ++i) {
                         reals += "0.5, ";
                       }
                       return reals;
                     }() +
                     "]"),
            "no UserError");
}

TEST(Config, FilesThatCannotBeReadAreNamed) {
  const test::TemporaryDirectory directory;
  const Schema schema = example();
  const auto error = [&](const std::filesystem::path& file) {
    return user_error_of([&] { (void)Config::from_file(schema, file); });
  };
  EXPECT_EQ(error(directory.path() / "no.toml"),
            (directory.path() / "no.toml").string() + ": cannot be read: No such file or directory");
  EXPECT_NE(error(directory.path()).find("Is a directory"), std::string::npos);
  const auto file = directory.path() / "a.toml";
  write_file(file, std::string(2 << 20, '\n'));
  EXPECT_NE(error(file).find("too long"), std::string::npos);
  write_file(file, "");
  EXPECT_EQ(Config::from_file(schema, file).integer("nodes"), 16);
  write_file(file, "\xef\xbb\xbfnodes = 7\r\n");
  EXPECT_EQ(Config::from_file(schema, file).integer("nodes"), 7);
}

TEST(Config, WhatNobodyReadsIsRefused) {
  Config config = read("nodes = 2\n[cache]\nways = 2\nsize = \"1 KiB\"\n", {"bus.latency=1ns"});
  EXPECT_EQ(user_error_of([&] { config.refuse_unused(); }),
            "a.toml:1: nodes: is not used by this configuration; leave it out");
  (void)config.integer("nodes");
  config.mark_unused_reason("cache", "the machine has no cache");
  config.mark_unused_reason("cache.ways", "the cache is fully associative");
  EXPECT_EQ(user_error_of([&] { config.refuse_unused(); }),
            "a.toml:3: cache.ways: is not used: the cache is fully associative");
  (void)config.integer("cache.ways");
  EXPECT_EQ(user_error_of([&] { config.refuse_unused(); }),
            "a.toml:4: cache.size: is not used: the machine has no cache");
  (void)config.size("cache.size");
  EXPECT_EQ(user_error_of([&] { config.refuse_unused(); }),
            "--set bus.latency=1ns: is not used by this configuration; leave it out");
  (void)config.values("bus.latency");
  config.refuse_unused();
}

TEST(Config, FailuresPointAtTheKey) {
  const Config config = read("nodes = 2\n", {"cache.ways=3"});
  EXPECT_EQ(user_error_of([&] { config.fail("nodes", "is wrong"); }), "a.toml:1: nodes: is wrong");
  EXPECT_EQ(user_error_of([&] { config.fail("cache.ways", "is wrong"); }), "--set cache.ways=3: is wrong");
  EXPECT_EQ(user_error_of([&] { config.fail("cache.size", "is wrong"); }), "a.toml: cache.size: is wrong");
}

TEST(Config, EffectiveValuesAreThoseRead) {
  const Config config = read("sweep.nodes = [3]\nnodes = 2", {"cache.size=2048"});
  (void)config.integers("sweep.nodes");
  (void)config.integer("nodes");
  (void)config.size("cache.size");
  (void)config.choice("cache.replacement");
  std::string listed;
  for (const EffectiveValue& value : config.effective_values()) {
    listed += value.key + " = " + value.value + (value.given ? " given " : " default ") + value.source + "\n";
  }
  EXPECT_EQ(listed,
            "cache.size = \"2 KiB\" given --set cache.size=2048\n"
            "cache.replacement = \"lru\" default default\n"
            "nodes = 2 given a.toml:2\n"
            "sweep.nodes = [3] given a.toml:1\n");
}

TEST(Config, ReadingAnUndeclaredKeyIsOurFault) {
  const Config config = read("");
  EXPECT_THROW((void)config.integer("no.such.key"), InternalError);
  EXPECT_THROW((void)config.integer("cache.size"), InternalError);
  EXPECT_THROW((void)config.integer("sweep.nodes"), InternalError);
  EXPECT_THROW((void)config.integers("nodes"), InternalError);
}

TEST(Schema, DeclarationsAreChecked) {
  Schema schema = example();
  EXPECT_THROW(schema.boolean("nodes", true, ""), InternalError);
  EXPECT_THROW(schema.boolean("cache", true, ""), InternalError);
  EXPECT_THROW(schema.boolean("nodes.sub", true, ""), InternalError);
  EXPECT_THROW(schema.boolean("Upper", true, ""), InternalError);
  EXPECT_THROW(schema.boolean("a..b", true, ""), InternalError);
  EXPECT_THROW(schema.integer("x", 0, {1, 2}, "", ""), InternalError);
  EXPECT_THROW(schema.choice("x", "c", {"a", "b"}, ""), InternalError);
  EXPECT_THROW(schema.size("x", "1 KiB", {"2 KiB", {}}, ""), InternalError);
  EXPECT_EQ(schema.keys().size(), example().keys().size());
}

// A printed default is accepted as input and gives the same value.
TEST(Schema, PrintedDefaultsReadBack) {
  const Schema schema = example();
  std::string text;
  for (const Key& key : schema.keys()) {
    text += key.name + " = " + print_values(key, key.default_value) + "\n";
  }
  const Config config = Config::from_text(schema, text, "defaults");
  for (const Key& key : schema.keys()) {
    EXPECT_TRUE(config.given(key.name)) << key.name;
    const auto values = config.values(key.name);
    EXPECT_EQ(std::vector<Value>(values.begin(), values.end()), key.default_value) << key.name;
  }
}

TEST(Schema, ListingsShowEveryKeyWithItsFacts) {
  const Schema schema = example();
  const std::string text = list_keys_as_text(schema, 60);
  const std::string markdown = list_keys_as_markdown(schema);
  for (const Key& key : schema.keys()) {
    EXPECT_NE(text.find("  " + key.name + " = "), std::string::npos) << key.name;
    EXPECT_NE(markdown.find("| `" + key.name + "` |"), std::string::npos) << key.name;
  }
  EXPECT_NE(text.find("[cache]\nThe private cache of a node.\n  cache.size = \"16 KiB\"\n"
                      "      0 B to 1 GiB\n      Capacity; 0 leaves the cache out\n"),
            std::string::npos)
      << text;
  EXPECT_NE(markdown.find("| `cache.ways` | `4` | integer in lines, at least 1 | Lines in a set |"),
            std::string::npos)
      << markdown;
}

RC_GTEST_PROP(Config, AnyTextEitherReadsOrIsAUserError, (const std::string& text)) {
  try {
    (void)read(text, {"scene.file=" + text});
  } catch (const UserError& error) {
    RC_ASSERT(std::string(error.what()).find(": ") != std::string::npos);
  }
}

TEST(Config, LettersBeyondAsciiBelongInTextsAndComments) {
  EXPECT_EQ(read("# caf\u00e9\nscene.file = \"caf\u00e9 \\\" \u2603\" # \u00e9").text("scene.file"),
            "caf\u00e9 \" \u2603");
  EXPECT_EQ(read("scene.file = \"\"\"\u00e9\"\u00e9\n\u00e9\"\"\"").text("scene.file"),
            "\u00e9\"\u00e9\n\u00e9");
  EXPECT_EQ(read("scene.file = '\u00e9\\'").text("scene.file"), "\u00e9\\");
  EXPECT_EQ(read("", {"scene.file=caf\u00e9"}).text("scene.file"), "caf\u00e9");
  EXPECT_EQ(read("\xEF\xBB\xBFscene.file = 'a'").text("scene.file"), "a");
  for (const char* const text :
       {"\u00e9 = 1", "\n\u00e9", "scene.file = 'a'\u00e9", "scene.\u00e9 = 'a'", "\u3000"}) {
    EXPECT_PRED_FORMAT2(testing::IsSubstring, "not ASCII", user_error_of([&] { (void)read(text); })) << text;
  }
}

RC_GTEST_PROP(Config, TextsSurvivePrinting, (const std::string& any)) {
  std::string text;
  for (const char c : any) {
    text += static_cast<char>(static_cast<unsigned char>(c) & 0x7fU);
  }
  const std::string line = "scene.file = " + print_value(ValueType::text, Value(text));
  RC_ASSERT(read(line).text("scene.file") == text);
}

RC_GTEST_PROP(Nearest, EditDistanceIsADistance, (const std::string& a, const std::string& b)) {
  RC_ASSERT(edit_distance(a, a) == 0U);
  RC_ASSERT(edit_distance(a, b) == edit_distance(b, a));
  RC_ASSERT(edit_distance(a, b) <= std::max(a.size(), b.size()));
  RC_ASSERT(edit_distance(a, b) + std::min(a.size(), b.size()) >= std::max(a.size(), b.size()));
  RC_ASSERT((edit_distance(a, b) == 0U) == (a == b));
  RC_ASSERT(edit_distance(a + "x", a) == 1U);
}

TEST(Nearest, KnownDistances) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(edit_distance("size", "szie"), 1U);
  EXPECT_EQ(edit_distance("", "abc"), 3U);
  EXPECT_EQ(nearest_name("hilbret", std::vector<std::string>{"scanline", "morton", "hilbert"}), "hilbert");
  EXPECT_EQ(nearest_name("xyz", std::vector<std::string>{"scanline", "morton"}), "");
}

}  // namespace
}  // namespace marti::sim
