"""Sphinx reads this; ``make site`` copies it beside the pages, see build.py.

That also puts the folder of this file onto the path, and that of what the examples share.
"""

from pathlib import Path

import matplotlib
import words
from words import PACKAGE, VERSION

matplotlib.use("Agg")

SITE = Path(words.__file__).parent

project = "asperity"
author = "The asperity developers"
project_copyright = author
version = release = VERSION

extensions = [
    "extension",
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.intersphinx",
    "sphinx.ext.napoleon",
    "sphinx_gallery.gen_gallery",
]
nitpicky = True
default_role = "name"
exclude_patterns = ["scripts/**", "**.ipynb", ".doctrees"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
suppress_warnings = ["config.cache"]

# Pages
myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence"]

# Reference: the pages are written by build.py, from the public names.
templates_path = [str(SITE / "templates")]
autosummary_generate = True
autosummary_generate_overwrite = False
autosummary_context = {
    "derived": {name.path for name in PACKAGE.names if name.is_class and PACKAGE.bases(name)},
    "on_page": {name.path: PACKAGE.members(name) for name in PACKAGE.names if name.is_class},
}
# Signatures are written by the extension, with the annotations as the sources have them.
autodoc_typehints = "none"
autodoc_preserve_defaults = True
autodoc_member_order = "bysource"
autodoc_class_signature = "mixed"
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 88
napoleon_numpy_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False
add_module_names = False
toc_object_entries_show_parents = "hide"

# Other projects, by inventories that are stored here: nothing is fetched.
intersphinx_mapping = {
    name: (address, str(Path("inventories") / f"{name}.inv"))
    for name, address in {
        "python": "https://docs.python.org/3/",
        "numpy": "https://numpy.org/doc/stable/",
        "matplotlib": "https://matplotlib.org/stable/",
        "pandas": "https://pandas.pydata.org/docs/",
        "xarray": "https://docs.xarray.dev/en/stable/",
    }.items()
}

# Gallery
sphinx_gallery_conf = {
    "examples_dirs": ["scripts/gallery", "scripts/paper"],
    "gallery_dirs": ["gallery", "paper"],
    "filename_pattern": r"/(?!measured_)\w+\.py$",
    "doc_module": ("asperity",),
    "backreferences_dir": "backreferences",
    "reference_url": {"asperity": None},
    "abort_on_example_error": True,
    "show_signature": False,
    "show_memory": False,
    "write_computation_times": False,
    "remove_config_comments": True,
    "download_all_examples": False,
    "plot_gallery": "True",
    "nested_sections": False,
    "within_subsection_order": "FileNameSortKey",
}

# Pages for people
html_theme = "pydata_sphinx_theme"
html_title = "asperity"
html_static_path = [str(SITE / "static")]
html_css_files = ["site.css"]
html_math_renderer = "unicode"
html_copy_source = False
html_show_sourcelink = False
html_theme_options = {
    "navbar_align": "left",
    "navbar_end": ["theme-switcher"],
    "navbar_persistent": ["search-field"],
    "header_links_before_dropdown": 6,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": [],
    "show_prev_next": False,
    "navigation_with_keys": False,
    "pygments_light_style": "default",
}
html_context = {"default_mode": "auto"}
