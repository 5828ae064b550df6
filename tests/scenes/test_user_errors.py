"""Every mistake in a suite, scene or material ends in one line: file, field and remedy."""

import pytest

from scenes.errors import InputError
from scenes.suite import expand, load_suite

MATERIAL = 'material = "copper"'
RUN = 'environments = ["studio"]'
BUDGET = 'techniques = ["paper"]\ntruths = ["global"]\n'


def changed(fields: str) -> str:
    return f'material = {{ use = "copper", {fields} }}'


# What is replaced, by what, and the file, field and remedy that the message must hold.
IN_SCENE = [
    (MATERIAL, 'material = "coper"', "object.0.material", "copper"),
    (MATERIAL, 'material = "own.toml"', "object.0.material", "a path starts at"),
    (MATERIAL, "material = 7", "object.0.material", "write text in quotes or a table"),
    (MATERIAL, "material = { weight = 1.0 }", "object.0.material", "add use"),
    (MATERIAL, changed("weight = 1.5"), "weight", "up to 1"),
    (MATERIAL, changed("weight = -0.5"), "weight", "from 0 up"),
    (MATERIAL, changed("weight = [0.6, 0.6]"), "weight", "sum to 1"),
    (MATERIAL, changed("weight = [1.2, -0.2]"), "weight", "from 0 to 1"),
    (MATERIAL, changed("weight = [0.5, 0.3, 0.2]"), "weight", "give [ggx, beckmann]"),
    (MATERIAL, changed("weight_g = [0.5, 0.6]"), "weight_g", "sum to 1"),
    (MATERIAL, changed("weight = nan"), "weight", "finite"),
    (MATERIAL, changed("colour = 1"), "colour", "roughness"),
    (MATERIAL, changed('metal = "Xx"'), "metal", "use one of Ag"),
    (MATERIAL, changed('f0 = "Cu"'), "f0", "use one of acrylic"),
    (MATERIAL, changed("f0 = [2.0, 0.0, 0.0]"), "f0", "up to 1"),
    (MATERIAL, changed("metallic = 0.5"), "material", "add albedo"),
    (MATERIAL, changed("roughness = 2.0"), "roughness", "up to 1"),
    (MATERIAL, changed('weight = "0.2"'), "weight", "give a number"),
    (MATERIAL, changed("weight = true"), "weight", "give a number"),
    (MATERIAL, changed("weight = [true, false]"), "weight", "from 0 to 1"),
    (MATERIAL, changed("roughness = true"), "roughness", "give a number"),
    (MATERIAL, changed('albedo = ["0.2", 0, 0]'), "albedo.0", "give a number"),
    (MATERIAL, changed("f0 = true"), "f0", "give a name, a number or [r, g, b]"),
    ('mesh = "sphere"', 'mesh = "sphre"', "object.0.mesh", "sphere, plane, globe, cylinder, bunny"),
    ('mesh = "sphere"', 'mesh = "none.ply"', "object.0.mesh", "a path starts at"),
    ('mesh = "sphere"', 'mesh = "a\\nb"', "object.0.mesh", "use one of"),
    ('mesh = "sphere"', 'mesh = "\\u0000.ply"', "object.0.mesh", "a path starts at"),
    ('mesh = "sphere"', f'mesh = "{"x" * 5000}.ply"', "object.0.mesh", "a path starts at"),
    ('mesh = "sphere"', f'mesh = "{"x" * 5000}"', "object.0.mesh", "use one of"),
    ('mesh = "sphere"', 'mesh = "sphere"\nscale = 0', "object.0.scale", "greater than 0"),
    ('mesh = "sphere"', 'mesh = "sphere"\nscale = "1"', "object.0.scale", "a number or a list"),
    ('mesh = "sphere"', 'mesh = "sphere"\nscale = [1, 1, 0]', "object.0.scale.2", "greater than 0"),
    ('mesh = "sphere"', 'mesh = "sphere"\nheight = -1', "object.0.height", "greater than 0"),
    ('mesh = "sphere"', 'mesh = "sphere"\nspin = 1', "object.0.spin", "FORMAT.md"),
    ('name = "ball"', 'name = "a/b"', "object.0.name", "letters"),
    ('name = "ball"', f'name = "{"n" * 300}"', "object.0.name", "up to 200 letters"),
    ('name = "ball"', f'name = "{"é" * 150}"', "object.0.name", "fewer with accents"),
    ("[64, 48]", "[0, 48]", "resolution.0", "greater than 0"),
    ("[64, 48]", "[64]", "resolution.1", "add it"),
    ("[64, 48]", "[64, 99999]", "resolution.1", "up to 16384"),
    ("fov = 30.0", "fov = 0.0", "camera.fov", "greater than 0"),
    ("fov = 30.0", 'fov = "30"', "camera.fov", "give a number"),
    ("fov = 30.0", "fov = 1e-2", "camera.fov", "from 0.0424 up"),
    ("fov = 30.0", "fov = 1e-12", "camera.fov", "from 0.0424 up"),
    ("fov = 30.0", "fov = 1e-300", "camera.fov", "from 0.0424 up"),
    ("fov = 30.0", "fov = 30.0\nup = [0, 0, 1e-200]", "camera", "up is 1e-200 long"),
    ("fov = 30.0", "fov = 30.0\nup = [0, 0, 1e9]", "camera", "up is 1e+09 long"),
    ("target = [0.0, 0.0, 0.0]", "target = [0.0, -4.0, 1e-300]", "camera", "move the target"),
    ("[64, 48]", "[64, true]", "resolution.1", "give a whole number"),
    ('mesh = "sphere"', 'mesh = "sphere"\njudged = 1', "object.0.judged", "true or false"),
    ("fov = 30.0", "", "camera.fov", "add it"),
    ("fov = 30.0", 'fov = 30.0\n"a/b" = 2', "camera", "unknown field 'a/b'"),
    ("fov = 30.0", "fov = 30.0\nzoom = 2", "camera.zoom", "FORMAT.md"),
    ("target = [0.0, 0.0, 0.0]", "target = [0.0, nan, 0.0]", "camera.target.1", "finite"),
    ("target = [0.0, 0.0, 0.0]", "target = [0.0, -4.0, 0.0]", "camera", "move the target"),
    ("fov = 30.0", "fov = 30.0\nup = [0, 0, 0]", "camera", "turn up"),
    ("[0.0, -4.0, 0.0]", "[0.0, -1e200, 0.0]", "camera.origin.1", "from -1e+15 up"),
    ("[camera]", "[camera", "line 4", "mend the syntax"),
    ("[camera]", "x = " + "[" * 5000, "is not TOML", "mend the syntax"),
]
IN_SUITE = [
    ('"studio"', '"studo"', "run.0.environments", "studio"),
    ('"studio"', '"none.exr"', "run.0.environments", "a path starts at"),
    (RUN, 'environments = ["sky.png"]', "run.0.environments", "convert it to .exr or .hdr"),
    (RUN, 'environments = ["sky.JPG"]', "run.0.environments", "convert it to .exr or .hdr"),
    (RUN, RUN + "\n[run.sweep]\nroughness = []", "run.0.sweep.roughness", "at least 1"),
    (RUN, RUN + "\n[run.sweep]\nroughness = [true]", "run.0.sweep.roughness.0", "give a number"),
    (RUN, "environments = []", "run.0.environments", "at least 1"),
    (RUN, RUN + "\nrotation = 1e308", "run.0.rotation", "up to 3600"),
    (RUN, RUN + "\nrotation = nan", "run.0.rotation", "finite"),
    (RUN, RUN + "\nresolution = [64, 0]", "run.0.resolution.1", "greater than 0"),
    (RUN, RUN + '\nmaterials = ["coper"]', "run.0.materials", "copper"),
    (RUN, RUN + "\nmaterial = 1", "run.0.material", "FORMAT.md"),
    (RUN, RUN + "\n[run.sweep]\nweight = [2.0]", "run.0.sweep.weight.0", "up to 1"),
    (RUN, RUN + "\n[run.sweep]\nweight = [[0.5, 0.6]]", "run.0.sweep.weight.0", "sum to 1"),
    (RUN, RUN + "\n[run.sweep]\nangle = [2.0]", "run.0.sweep.angle", "FORMAT.md"),
    (RUN, 'environments = ["studio", "studio"]', "ball.studio", "remove one"),
    ('"ball.toml"', '"none.toml"', "run.0.scene", "a path starts at"),
    ('"ball.toml"', '"none"', "run.0.scene", "bunnies"),
    ('["global"]', '["globe"]', "truths.0", "'global'"),
    ('["paper"]', '["paper", "paper"]', "techniques", "leave one"),
    ('["paper"]', "[]", "techniques", "at least 1"),
    ('["global"]', '["global"]\nbudgets = 1', "budgets", "budget"),
    ("[[run]]", "[run]", "run", "[[run]]"),
    (BUDGET, BUDGET + "[reference]\nmax_samples = 10", "reference", "give at least"),
    (BUDGET, BUDGET + '[model]\nmasking = "none"', "model.masking", "'paper' or 'smith'"),
    (BUDGET, BUDGET + '[model]\nfresnel = "f90"', "model.fresnel", "'schlick', 'f82' or 'exact'"),
    (BUDGET, BUDGET + '[model]\nkd = "interface"', "model", "add fresnel = 'exact'"),
    (
        BUDGET,
        BUDGET + '[[budget]]\ntechnique = "paper"\ntruth = "global"\nscene = "ball"',
        "budget.0",
        "add reason",
    ),
    (
        BUDGET,
        BUDGET + '[[budget]]\ntechnique = "paper"\ntruth = "global"\nssim = 2.0',
        "budget.0.ssim",
        "up to 1",
    ),
]


@pytest.mark.parametrize(("old", "new", "field", "remedy"), IN_SCENE, ids=lambda v: str(v)[:40])
def test_a_mistake_in_a_scene_names_the_scene(write_suite, refused, old, new, field, remedy):
    path = write_suite(old, new)
    refused(lambda: expand(*load_suite(str(path))), "ball.toml", field, remedy)


@pytest.mark.parametrize(("old", "new", "field", "remedy"), IN_SUITE, ids=lambda v: str(v)[:40])
def test_a_mistake_in_a_suite_names_the_suite(write_suite, refused, old, new, field, remedy):
    path = write_suite(old, new)
    refused(lambda: expand(*load_suite(str(path))), str(path), field, remedy)


def test_a_mistake_in_a_material_names_the_material(write_suite, refused, tmp_path):
    path = write_suite(MATERIAL, 'material = "own.toml"')
    (tmp_path / "own.toml").write_text('roughness = 3.0\nmetallic = 1.0\nmetal = "Au"\n')
    refused(lambda: expand(*load_suite(str(path))), "own.toml", "roughness", "up to 1")


@pytest.mark.parametrize("own", ["weight = 1.2", "weight_g = 1.2"])
@pytest.mark.parametrize("changed_by", ["sweep", "object"])
def test_a_mistake_that_is_overridden_is_still_refused(
    write_suite, refused, tmp_path, own, changed_by
):
    used = "{ use = 'own.toml', weight = 0.5, weight_g = 0.5 }"
    used = used if changed_by == "object" else "'own.toml'"
    path = write_suite(MATERIAL, f"material = {used}")
    (tmp_path / "own.toml").write_text(f'roughness = 0.5\nmetallic = 1.0\nmetal = "Au"\n{own}\n')
    if changed_by == "sweep":
        path.write_text(path.read_text() + "[run.sweep]\nweight = [0.5]\n")
    error = refused(lambda: expand(*load_suite(str(path))), "own.toml", "weight", "up to 1")
    assert "as changed by" not in str(error)


def test_a_missing_file_is_named_whole(refused, tmp_path):
    path = tmp_path / ("a" * 60) / ("b" * 60) / "suite.toml"
    refused(lambda: load_suite(str(path)), str(path))


def test_integers_are_numbers(write_suite):
    path = write_suite("fov = 30.0", "fov = 30")
    assert expand(*load_suite(str(path)))[0].case.camera.fov == 30.0


@pytest.mark.parametrize(
    ("truths", "told"),
    [
        ('["global"]', "add unoccluded, direct, physical to truths"),
        ('["unoccluded", "direct", "global"]', "add physical to truths"),
        ('["direct", "global", "physical"]', "add unoccluded to truths"),
    ],
)
@pytest.mark.parametrize("whole", [True, False], ids=["of the suite", "of the run"])
def test_a_split_of_an_error_that_is_not_measured_is_refused(
    write_suite, refused, truths, told, whole
):
    path = write_suite(
        RUN, f"{RUN}\nsplit_model = true" + ("" if whole else f"\ntruths = {truths}")
    )
    if whole:
        path.write_text(path.read_text().replace('truths = ["global"]', f"truths = {truths}"))
    refused(lambda: expand(*load_suite(str(path))), "run.0.split_model", told, "or leave it out")


def test_a_split_of_all_its_truths_is_taken(write_suite):
    path = write_suite(RUN, f"{RUN}\nsplit_model = true")
    every = 'truths = ["physical", "global", "direct", "unoccluded"]'
    path.write_text(path.read_text().replace('truths = ["global"]', every))
    assert all(e.split_model for e in expand(*load_suite(str(path))))


def test_two_objects_of_one_name_are_refused(write_suite, refused, tmp_path):
    path = write_suite()
    scene = (tmp_path / "ball.toml").read_text()
    (tmp_path / "ball.toml").write_text(scene + scene[scene.index("[[object]]") :])
    refused(lambda: expand(*load_suite(str(path))), "ball.toml", "object", "give each its own")


def test_a_file_whose_name_cannot_stand_in_a_case_is_refused(write_suite, refused, tmp_path):
    path = write_suite('"ball.toml"', '"my ball.toml"')
    (tmp_path / "ball.toml").rename(tmp_path / "my ball.toml")
    refused(lambda: expand(*load_suite(str(path))), "suite.toml", "run.0", "rename the file")


@pytest.mark.parametrize("name", ["defualt", "none/such.toml", "."])
def test_an_unknown_suite_is_refused(refused, name):
    refused(lambda: load_suite(name), "--suite", "suite", "path")


@pytest.mark.parametrize(
    ("content", "remedy"),
    [
        (b"\xff\xfe\x00", "(line 1); save it as UTF-8"),
        (b"# a\n\xe9", "(line 2); save it as UTF-8"),
        (b"= 1", "mend the syntax"),
        (b'description = "a\nb"', "mend the syntax"),
        (b"description = " + b"9" * 5000, "digits); mend the syntax"),
    ],
)
def test_a_suite_that_is_not_toml_is_refused(refused, tmp_path, content, remedy):
    (tmp_path / "bad.toml").write_bytes(content)
    refused(lambda: load_suite(str(tmp_path / "bad.toml")), "bad.toml", remedy)


def test_an_empty_suite_is_told_its_first_missing_field(refused, tmp_path):
    (tmp_path / "empty.toml").write_text("")
    refused(lambda: load_suite(str(tmp_path / "empty.toml")), "empty.toml", "description", "add it")


def test_a_message_of_many_lines_becomes_one():
    error = InputError("a\nb.toml", "field", "a library\n  said this", "mend\r\nit")
    assert str(error) == "a b.toml: field: a library said this; mend it"


def test_what_does_not_print_is_escaped_and_the_middle_of_a_long_text_left_out():
    error = InputError("\u202egpj.exr", "nul\0", "\x1b[31mred", "x" * 5000)
    assert str(error).isprintable() and len(str(error)) < 600
    assert r"\u202egpj.exr: nul\x00: \x1b[31mred; xxx" in str(error) and " ... " in str(error)


def test_a_value_that_holds_a_semicolon_does_not_cut_the_problem(write_suite, refused):
    path = write_suite(MATERIAL, changed('metal = "a; b"'))
    refused(lambda: expand(*load_suite(str(path))), "unknown metal 'a; b'; use one of Ag")
