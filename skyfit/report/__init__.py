"""The report on the paper's pipeline: numbers, pictures, claims, and the page that shows them.

- `pipeline`: the public verb, `reproduce`;
- `coefficients`, `reality`, `claims`: what is compared, in numbers;
- `skies`: simulated skies between their directions, and models beside them;
- `style`, `charts`, `domes`: pictures;
- `page`: report.html.
"""
