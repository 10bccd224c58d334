// SPDX-License-Identifier: MIT
// Hello.exe ASSET.sphc PALETTES: which body parts are inside each other, frame by frame. The same lines as samples/hello.
using System;
using System.Globalization;
using System.IO;
using Spherechain;

public static class Hello
{
    static void Play(byte[] file, Palettes model)
    {
        // [hello]
        // Your skeleton: names and inverse bind matrices. The character allocates here, never in a frame.
        using (Character character = new Character(file, model.Joints, model.InverseBinds, MatrixLayout.Columns4x4))
        {
            character.CheckRest(model.Rest, MatrixLayout.Columns4x4);
            for (int frame = 0; frame < model.Frames.Length; ++frame)
            {
                float[] palette = model.Frames[frame];  // what your skinning shader gets
                int count = character.FindPenetrations(palette, MatrixLayout.Columns4x4);
                for (int i = 0; i < count; ++i)
                {
                    Penetration found = character.Penetrations[i];
                    if (found.Kind != PenetrationClass.Penetration) continue;  // folds at joints, touches ...
                    Print(frame, character.Asset, found);
                }
            }
        }
        // [/hello]
    }

    static void Print(int frame, Asset asset, Penetration found)
    {
        string[] parts = asset.PartNames;
        Vec3 way = found.Direction;  // the way that the part must go
        Console.WriteLine("frame {0}: {1} in {2}, {3} mm; out along ({4}, {5}, {6})", frame, parts[found.Part], parts[found.Other],
                          Number(1000 * asset.MetresPerUnit * found.Measures.Depth, "F0"), Number(way.X, "F2"), Number(way.Y, "F2"),
                          Number(way.Z, "F2"));
    }

    // As C prints it: with the sign of -0.00.
    static string Number(float value, string format)
    {
        bool isNegative = value < 0 || (value == 0 && 1 / value < 0);
        return (isNegative ? "-" : "") + Math.Abs((double)value).ToString(format, CultureInfo.InvariantCulture);
    }

    public static int Main(string[] arguments)
    {
        if (arguments.Length != 2)
        {
            Console.Error.WriteLine("usage: Hello.exe ASSET.sphc PALETTES");
            return 2;
        }
        try
        {
            Play(File.ReadAllBytes(arguments[0]), new Palettes(arguments[1]));
            return 0;
        }
        catch (Exception error) when (error is SpherechainException || error is IOException)
        {
            Console.Error.WriteLine("hello: error: " + error.Message);
            return 3;
        }
    }
}
