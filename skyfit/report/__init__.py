"""The report on the paper's pipeline: numbers, pictures, claims, and the page that shows them.

- `pipeline`: the public verb, `reproduce`;
- `coefficients`, `reality`, `claims`: what is compared, in numbers;
- `pictures`, `reality_chart`: which pictures there are; most are drawn by `skyfit.plots`;
- `page`: report.html.
"""
