#!/usr/bin/python3
import figures

figures.main("All figures of a sweep that apply to it.")
