"""What a command line refers to must exist: subcommands and options of marti, configuration keys, files of the
project, presets and targets of CMake."""

import json
import re

import document


class WrongReference(Exception):
    """A command names something that is not there."""


class Checker:
    # What the program says of itself is asked for once, however many documents are checked.
    helps, known_keys = {}, set()

    def __init__(self, runner, source):
        self.runner, self.source = runner, source

    def help_of(self, path):
        """The help of a subcommand, given as a tuple of words; nothing if there is none."""
        if path not in self.helps:
            status, text = self.runner.run(" ".join(("marti",) + path + ("--help",)))
            self.helps[path] = text if status == 0 else ""
        return self.helps[path]

    def has(self, subcommand):
        return subcommand in self.subcommands(())

    def subcommands(self, path):
        listed = self.help_of(path).partition("Subcommands:\n")[2]
        return re.findall(r"^  ([a-z]+)\b", listed, re.MULTILINE)

    def keys(self):
        if not self.known_keys:
            _, text = self.runner.run("marti config")
            self.known_keys.update(re.findall(r"^  ([a-z0-9_.]+) = ", text, re.MULTILINE))
        return self.known_keys

    def check(self, text):
        """Throws if the command names what is not there. It may leave arguments out, or stand for some."""
        for part in re.split(r"\s(?:&&|\|\||;|\|)\s", text):
            words = document.words_of(part)
            if not words:
                continue
            if words[0].endswith("build/release/studies/marti"):
                words[0] = "marti"
            if words[0] in ("mpirun", "srun") and "marti" in words:
                words = words[words.index("marti"):]
            if words[0] == "marti":
                self.check_marti(words[1:])
            else:
                self.check_other(words)

    def check_marti(self, words):
        words = [word.strip("[]") for word in words]
        path = ()
        while words and self.subcommands(path):
            names = words[0].split("|")
            if names[0].startswith("-") or names == ["..."]:
                break
            for name in names:
                if name not in self.subcommands(path):
                    raise WrongReference(f"marti {' '.join(path)} has no subcommand {name}")
            path += (names[0],)
            words = words[1:]
        known = self.help_of(path)
        for index, word in enumerate(words):
            if re.match(r"--?[a-z]", word):
                option = word.partition("=")[0]
                if not re.search(rf"(?:^|[\s,]){re.escape(option)}(?=[\s,]|$)", known, re.MULTILINE):
                    raise WrongReference(f"marti {' '.join(path)} has no option {option}")
            elif "=" in word and words[index - 1] == "--set":
                key = word.partition("=")[0]
                if key != "key" and key not in self.keys():
                    raise WrongReference(f"there is no key {key}")
            elif re.match(r"configs/\S+\.toml$", word):
                self.must_exist(word)

    def must_exist(self, name):
        if not (self.source / name).exists():
            raise WrongReference(f"there is no {name}")

    def check_other(self, words):
        if words[0].startswith("./") or re.match(r"(cmake|docs|bench|tests)/", words[0]):
            self.must_exist(words[0])
        if words[0] == "python3" and len(words) > 1 and "/" in words[1]:
            self.must_exist(words[1])
        for index, word in enumerate(words[1:], 1):
            before = words[index - 1]
            if before == "--preset":
                self.check_preset(word, words)
            elif before == "--target":
                self.check_target(word)
            elif re.match(r"-D(MARTI_\w+)", word):
                self.check_declared(rf"(option|set)\({word[2:].partition('=')[0]}\b", word)
            elif re.match(r"configs/\S+\.toml$", word):
                self.must_exist(word)

    def check_preset(self, name, words):
        presets = json.loads((self.source / "CMakePresets.json").read_text(encoding="utf-8"))
        kind = "configurePresets"
        if "--workflow" in words:
            kind = "workflowPresets"
        elif "--build" in words:
            kind = "buildPresets"
        elif words[0] == "ctest":
            kind = "testPresets"
        if name not in [preset["name"] for preset in presets[kind]]:
            raise WrongReference(f"CMakePresets.json has no {name} among its {kind}")

    def check_target(self, name):
        self.check_declared(rf"(add_executable|add_library|add_custom_target|marti_add_\w+)\({re.escape(name)}\b", name)

    def check_declared(self, pattern, name):
        files = [*self.source.glob("*/CMakeLists.txt"), *self.source.glob("tests/*/CMakeLists.txt"),
                 *self.source.glob("cmake/*.cmake"), self.source / "CMakeLists.txt"]
        if not any(re.search(pattern, file.read_text(encoding="utf-8")) for file in files):
            raise WrongReference(f"no CMake file declares {name}")
