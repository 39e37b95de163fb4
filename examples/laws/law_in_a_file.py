"""How do I keep a law so that others can check it?
================================================

A law in a file is text that people can read, and it can say where it comes from. Learn how to write
one with its source, what is found if someone changes the source, and how to describe it.
"""

import tempfile
from pathlib import Path

import asperity as asp
import matplotlib.pyplot as plt
from asperity import predict

folder = tempfile.TemporaryDirectory()
data, file = Path(folder.name) / "readings.csv", Path(folder.name) / "pvc.toml"

# %%
# A law and its provenance
# ------------------------
# The file names what it was made of, with a digest.

data.write_text("angle [deg],force [N]\n0,4.99\n90,4.25\n", encoding="utf-8")
law = asp.FrictionLaw(asp.Superellipse(0.537, 0.457, 2.94), asp.Superellipse(1.84, 1.19, 2.51))
source = asp.Provenance.of_files([data], note="PVC on ground steel, dry", made_by="a script")
asp.LawFile(law, provenance=source).save(file)
text = file.read_text(encoding="utf-8")
print(text)

# %%
# Read again
# ----------
# The law is the same to the bit, and a mistake in the text is named with its line and what is
# allowed.

read = asp.LawFile.load(file)
print(f"the same law: {read.law == law}; {read.provenance.note}")
wrong = file.with_name("wrong.toml")
wrong.write_text(text.replace("exponent", "exponnet"), encoding="utf-8")
try:
    asp.FrictionLaw.load(wrong)
except asp.ConfigurationError as refused:
    print(f"line {refused.line}: {refused.key}: {str(refused).split(': ', 2)[-1]}")

# %%
# What is in it?
# --------------
# ``describe_law`` answers for any file of a law, as ``asperity law FILE`` does in a shell.

sheet = predict.describe_law(file)
print(sheet.summary())

# %%

with asp.plot.style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 4.4), layout="constrained")
    asp.plot.plot_law(sheet.law, ax=left)
    left.set_title("The law in the file")
    asp.plot.plot_friction_coefficient(sheet.law, ax=right)
    right.set_title("Coefficients against and across the sliding")
plt.show()
folder.cleanup()
